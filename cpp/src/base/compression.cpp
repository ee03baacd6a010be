#include "helibore/compression.hpp"

#include <algorithm>
#include <bit>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>

#include "base/messages.hpp"
#include "base/row_hash.hpp"
#include "helibore/error.hpp"

namespace helibore {

static_assert(std::endian::native == std::endian::little);

namespace {

using Word = std::uint64_t;
using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t block = 1024;
constexpr std::size_t most_entries = 1 << 16;
constexpr std::size_t run = 8 * block, runs = 8;  // of words that decide the form
constexpr std::size_t word_bytes = sizeof(Word);
constexpr std::size_t block_head = word_bytes + 1;
enum Form : std::uint8_t { as_steps = 1, in_table = 2 };

// What stands before the bits of a block.
struct Head {
    Word least;
    int width;

    std::size_t words(std::size_t count) const { return (count * static_cast<std::size_t>(width) + 63) / 64; }
};

Head head_of(std::span<const Word> numbers) {
    auto least = static_cast<std::int64_t>(numbers[0]), greatest = least;
    for (const Word number : numbers) {
        least = std::min(least, static_cast<std::int64_t>(number));
        greatest = std::max(greatest, static_cast<std::int64_t>(number));
    }
    const auto first = static_cast<Word>(least);
    return {first, static_cast<int>(std::bit_width(static_cast<Word>(greatest) - first))};
}

template <class Job>
void for_each_block(std::size_t count, const Job& job) {
    for (std::size_t start = 0; start < count; start += block) job(start, std::min(block, count - start));
}

void write_word(Bytes& bytes, Word word) {
    const std::size_t end = bytes.size();
    bytes.resize(end + word_bytes);
    std::memcpy(bytes.data() + end, &word, word_bytes);
}

void write_block(Bytes& bytes, std::span<const Word> numbers) {
    const Head head = head_of(numbers);
    write_word(bytes, head.least);
    bytes.push_back(static_cast<std::uint8_t>(head.width));
    bytes.resize(bytes.size() + word_bytes * head.words(numbers.size()));
    std::uint8_t* into = bytes.data() + bytes.size() - word_bytes * head.words(numbers.size());
    Word bits = 0;
    int used = 0;
    const auto put = [&] { std::memcpy(std::exchange(into, into + word_bytes), &bits, word_bytes); };
    for (const Word number : numbers) {
        const Word value = number - head.least;
        bits |= value << used;
        used += head.width;
        if (used < 64) continue;
        put();
        used -= 64;
        bits = used == 0 ? 0 : value >> (head.width - used);
    }
    if (used > 0) put();
}

// Words in one of the four forms. The numbers of a block are made when they are needed: columns are large.
struct Formed {
    std::span<const Word> words;
    int form = 0, shift = 0;
    std::vector<Word> table;
    std::vector<std::uint32_t> places;  // in the table, one for each word

    Word stated(std::size_t i) const { return form & as_steps && i > 0 ? words[i] - words[i - 1] : words[i]; }

    std::span<const Word> numbers(std::size_t start, std::span<Word> into) const {
        for (std::size_t i = 0; i < into.size(); ++i)
            into[i] = form & in_table ? places[start + i] : stated(start + i) >> shift;
        return into;
    }

    template <class Job>
    void for_each_block_of_numbers(const Job& job) const {
        Word some[block];
        for_each_block(words.size(), [&](std::size_t start, std::size_t count) {
            job(numbers(start, std::span<Word>(some).first(count)));
        });
    }

    std::size_t size_of_table() const { return form & in_table ? word_bytes * (table.size() + 1) : 0; }

    std::size_t size_of_blocks() const {
        std::size_t size = 0;
        for_each_block_of_numbers(
            [&](std::span<const Word> some) { size += block_head + word_bytes * head_of(some).words(some.size()); });
        return size;
    }
};

Formed shifted(std::span<const Word> words, int form) {
    Formed made;
    made.words = words;
    made.form = form;
    Word any = 0;
    for (std::size_t i = 0; i < words.size(); ++i) any |= made.stated(i);
    made.shift = any == 0 ? 0 : static_cast<int>(std::countr_zero(any));
    return made;
}

// Returns nothing if there are more than `most` different words or steps.
std::optional<Formed> tabled(std::span<const Word> words, int form, std::size_t most) {
    constexpr int slot_bits = 18;
    std::vector<std::uint32_t> slots(std::size_t{1} << slot_bits);  // 0: empty; else the place in the table, plus 1
    Formed made;
    made.words = words;
    made.form = form;
    made.places.reserve(words.size());
    for (std::size_t i = 0; i < words.size(); ++i) {
        const Word word = made.stated(i);
        auto at = static_cast<std::size_t>((word ^ word >> 29) * 0x9E3779B97F4A7C15u >> (64 - slot_bits));
        while (slots[at] != 0 && made.table[slots[at] - 1] != word) at = (at + 1) % slots.size();
        if (slots[at] == 0) {
            if (made.table.size() >= most) return std::nullopt;
            made.table.push_back(word);
            slots[at] = static_cast<std::uint32_t>(made.table.size());
        }
        made.places.push_back(slots[at] - 1);
    }
    return made;
}

std::optional<Formed> formed(std::span<const Word> words, int form, std::size_t most) {
    if (form & in_table) return tabled(words, form, most);
    return shifted(words, form);
}

// Returns the form that is the shortest for some runs of the words, which lie at equal distances. The step from one run
// to the next spoils one block in eight.
int best_form(std::span<const Word> words) {
    const std::size_t apart = run * std::max<std::size_t>(1, words.size() / (runs * run));
    std::vector<Word> some;
    for (std::size_t start = 0; start < words.size(); start += apart) {
        const auto taken = words.subspan(start, std::min(run, words.size() - start));
        some.insert(some.end(), taken.begin(), taken.end());
    }
    int best = 0;
    double least = std::numeric_limits<double>::infinity();
    for (const int form : {0, int{as_steps}, int{in_table}, as_steps | in_table}) {
        const auto made = formed(some, form, std::min(most_entries, some.size() * 3 / 4));
        if (!made) continue;
        const double of_all = static_cast<double>(words.size()) / static_cast<double>(some.size());
        const double size =
            static_cast<double>(made->size_of_blocks()) * of_all + static_cast<double>(made->size_of_table());
        if (size < least) least = size, best = form;
    }
    return best;
}

// Takes bytes from the front of what is left.
class Reader {
  public:
    explicit Reader(std::span<const std::uint8_t> bytes) : bytes_(bytes) {}

    std::span<const std::uint8_t> take(std::size_t count) {
        require(count <= bytes_.size());
        const auto taken = bytes_.first(count);
        bytes_ = bytes_.subspan(count);
        return taken;
    }
    int byte() { return take(1)[0]; }
    Word word() {
        Word word = 0;
        std::memcpy(&word, take(word_bytes).data(), word_bytes);
        return word;
    }
    std::size_t left() const { return bytes_.size(); }

    static void require(bool right) {
        if (!right) throw InputError("compressed column", "is damaged");
    }

  private:
    std::span<const std::uint8_t> bytes_;
};

// Reads the next numbers and calls set(i, number) for each.
template <class Set>
void read_block(Reader& reader, std::size_t count, const Set& set) {
    const Head head{reader.word(), reader.byte()};
    Reader::require(head.width <= 64);
    const auto bytes = reader.take(word_bytes * head.words(count));
    std::uint8_t bits[word_bytes * (block + 1)];  // one word more, so that the last number may look at the next one
    std::memcpy(bits, bytes.data(), bytes.size());
    std::memset(bits + bytes.size(), 0, word_bytes);
    const auto width = static_cast<std::size_t>(head.width);
    const Word mask = width == 0 ? 0 : ~Word{0} >> (64 - width);
    const auto word_at = [&bits](std::size_t byte) {
        Word word = 0;
        std::memcpy(&word, bits + byte, word_bytes);
        return word;
    };
    if (width <= 57) {  // within 8 bytes
        for (std::size_t i = 0, place = 0; i < count; ++i, place += width)
            set(i, head.least + (word_at(place / 8) >> place % 8 & mask));
    } else {
        for (std::size_t i = 0, place = 0; i < count; ++i, place += width) {
            const std::size_t byte = place / 64 * word_bytes, from = place % 64;
            set(i, head.least + ((word_at(byte) >> from | word_at(byte + word_bytes) << 1 << (63 - from)) & mask));
        }
    }
}

}  // namespace

std::vector<std::uint8_t> compress(std::span<const std::uint64_t> words) {
    const int form = words.empty() ? 0 : best_form(words);
    const std::optional<Formed> made = formed(words, form, most_entries);
    const Formed best = made ? *made : shifted(words, form & as_steps);
    Bytes bytes;
    bytes.push_back(static_cast<std::uint8_t>(best.form));
    bytes.push_back(static_cast<std::uint8_t>(best.shift));
    if (best.form & in_table) {
        write_word(bytes, best.table.size());
        for (const Word word : best.table) write_word(bytes, word);
    }
    best.for_each_block_of_numbers([&](std::span<const Word> numbers) { write_block(bytes, numbers); });
    return bytes;
}

void decompress(std::span<const std::uint8_t> bytes, std::span<std::uint64_t> words) {
    Reader reader(bytes);
    const int form = reader.byte(), shift = reader.byte();
    Reader::require(form <= (as_steps | in_table) && shift < 64);
    std::vector<Word> table;
    if (form & in_table) {
        const Word entries = reader.word();
        Reader::require(entries <= most_entries);
        table.resize(entries);
        for (Word& entry : table) entry = reader.word();
    }
    const auto read = [&](const auto& stated) {
        Word last = 0;
        for_each_block(words.size(), [&](std::size_t start, std::size_t count) {
            Word* const into = words.data() + start;
            if (form & as_steps)
                read_block(reader, count, [&](std::size_t i, Word number) { into[i] = last += stated(number); });
            else
                read_block(reader, count, [&](std::size_t i, Word number) { into[i] = stated(number); });
        });
    };
    if (form & in_table)
        read([&table](Word number) {
            Reader::require(number < table.size());
            return table[number];
        });
    else
        read([shift](Word number) { return number << shift; });
    Reader::require(reader.left() == 0);
}

std::uint64_t sum_of_rows(std::span<const std::span<const double>> columns) {
    const std::size_t count = columns.empty() ? 0 : columns[0].size();
    for (std::size_t c = 0; c < columns.size(); ++c)
        require_length(entry_name("columns", static_cast<Index>(c)), columns[c].size(), count, "columns[0]");
    std::uint64_t sum = 0;
    for (std::size_t i = 0; i < count; ++i) {
        std::uint64_t hash = 0;
        for (const std::span<const double> column : columns) hash = with_number(hash, column[i]);
        sum += hash;
    }
    return sum;
}

}  // namespace helibore
