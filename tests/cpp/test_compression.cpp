// Compression of columns: what comes back is what was given, damage is refused, and rows have one sum in any order.
#include <array>
#include <bit>
#include <limits>
#include <random>
#include <vector>

#include "check.hpp"
#include "helibore/compression.hpp"
#include "helibore/error.hpp"

namespace {

using Words = std::vector<std::uint64_t>;

void comes_back(const Words& words, std::size_t at_most) {
    const std::vector<std::uint8_t> bytes = helibore::compress(words);
    CHECK(bytes.size() <= at_most);
    Words found(words.size(), 1);
    helibore::decompress(bytes, found);
    CHECK(found == words);
    for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 50)
        CHECK_THROWS(helibore::InputError, "compressed column: is damaged",
                     helibore::decompress({bytes.data(), size}, found));
    std::vector<std::uint8_t> longer = bytes;
    longer.push_back(0);
    CHECK_THROWS(helibore::InputError, "compressed column: is damaged", helibore::decompress(longer, found));
}

}  // namespace

int main() {
    std::mt19937_64 random(1);
    Words noise(3000), steps(3000), few(3000), same(3000, std::bit_cast<std::uint64_t>(0.1));
    for (std::size_t i = 0; i < noise.size(); ++i) {
        noise[i] = random();
        steps[i] = 7 * i + (i > 2000 ? std::numeric_limits<std::uint64_t>::max() : 0);
        few[i] = std::bit_cast<std::uint64_t>(0.1 + 0.001 * static_cast<double>(random() % 9));
    }
    comes_back({}, 100);
    comes_back({0}, 100);
    comes_back(noise, 8 * 3000 + 300);
    comes_back(steps, 1000);
    comes_back(few, 3000);
    comes_back(same, 200);

    const std::vector<double> a{1.0, 2.0, 3.0}, b{0.5, 0.25, -0.0}, turned_a{3.0, 1.0, 2.0}, turned_b{-0.0, 0.5, 0.25};
    const std::vector<double> zero{0.5, 0.25, 0.0}, two{1.0, 2.0};
    const auto sum = [](std::span<const double> one, std::span<const double> other) {
        const std::array columns{one, other};
        return helibore::sum_of_rows(columns);
    };
    CHECK(sum(a, b) == sum(turned_a, turned_b));
    CHECK(sum(a, b) != sum(a, turned_b) && sum(a, b) != sum(b, a) && sum(a, b) != sum(a, zero));
    CHECK_THROWS(helibore::InputError, "columns[1] has 2 values, columns[0] has 3: must be equal", sum(a, two));
    return failures();
}
