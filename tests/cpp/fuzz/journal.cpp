// The journal: all records of an intact segment come back; of a damaged one only records that were written, in order,
// and damage covers all else.
#include "helibore/journal.hpp"

#include <algorithm>

#include "input.hpp"

namespace journal = helibore::journal;
using helibore::Index;

namespace {

// Records and damage follow one another and make up the bytes.
void require_whole(const journal::Scan& scan, std::size_t from, std::size_t size) {
    auto at = static_cast<Index>(std::min(from, size));
    std::size_t damage = 0;
    const auto pass_damage = [&] {
        if (damage < scan.damage.size() && scan.damage[damage].start == at) at = scan.damage[damage++].stop;
    };
    std::uint64_t next = 0;
    for (const journal::Record& record : scan.records) {
        pass_damage();
        require_rule(record.offset == at + static_cast<Index>(journal::header_size), "records and damage are apart");
        require_rule(record.sequence >= next, "sequence numbers grow");
        next = record.sequence + 1;
        at = record.offset + static_cast<Index>(record.length);
    }
    pass_damage();
    require_rule(at == static_cast<Index>(size) && damage == scan.damage.size(), "they make up the bytes");
}

}  // namespace

void fuzz(Input input) {
    const auto salt = static_cast<std::uint32_t>(input.below(65536));
    std::string segment;
    std::string foreign;  // the same records, of another journal
    std::vector<std::string> payloads;
    std::uint64_t sequence = input.below(3);
    for (std::size_t n = input.below(6); n > 0; --n) {
        std::string payload(input.text(input.below(300)));
        if (input.one_in(4)) payload += "HLBJ";
        if (input.one_in(4)) payload += foreign;  // records within a payload are no records
        journal::Record record;
        record.sequence = sequence;
        record.wall = static_cast<std::int64_t>(input.byte()) - 128;
        record.kind = input.byte();
        const auto header = journal::seal(record, payload, salt);
        segment.append(header.data(), header.size()).append(payload);
        const auto sealed = journal::seal(record, payload, ~salt);
        foreign.append(sealed.data(), sealed.size()).append(payload);
        payloads.push_back(payload);
        sequence += 1 + input.below(3);
    }
    const journal::Scan intact = journal::scan(segment, 0, salt);
    require_rule(intact.records.size() == payloads.size() && intact.damage.empty(), "an intact segment is read whole");
    for (std::size_t i = 0; i < payloads.size(); ++i) {
        const journal::Record& record = intact.records[i];
        require_rule(segment.substr(static_cast<std::size_t>(record.offset), record.length) == payloads[i], "payloads");
    }
    std::string damaged = segment;
    for (std::size_t n = input.below(4); n > 0 && !damaged.empty(); --n) {
        const std::size_t at = input.below(65536) % damaged.size();
        if (input.one_in(4))
            damaged.erase(at, 1 + input.below(60));
        else if (input.one_in(4))
            damaged.insert(at, input.text(input.below(60)));
        else
            damaged[at] = static_cast<char>(damaged[at] ^ (1 << input.below(8)));
    }
    const std::size_t from = input.one_in(8) ? input.below(700) : 0;
    const journal::Scan scan = journal::scan(damaged, from, salt);
    require_whole(scan, from, damaged.size());
    for (const journal::Record& record : scan.records) {
        const std::string payload = damaged.substr(static_cast<std::size_t>(record.offset), record.length);
        require_rule(std::ranges::find(payloads, payload) != payloads.end(), "only what was written comes back");
    }
    const std::string_view rest = input.text(input.left());
    require_whole(journal::scan(rest, 0, salt), 0, rest.size());
}
