// The host's threads in place of the library's: the same bits, and at most 64 KB of stack used, on every instruction
// set. test_c.cpp has runners that break their contract.
#include "helibore/runner.hpp"

#include "check.hpp"
#include "helibore/error.hpp"
#include "helibore/estimates.hpp"
#include "helibore/image.hpp"
#include "helibore/logs.hpp"
#include "helibore/surface.hpp"
#include "hole.hpp"

#ifdef __unix__
#include <pthread.h>
#include <sys/mman.h>

#include <algorithm>
#include <cstring>

namespace {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__) || !defined(__OPTIMIZE__)
constexpr std::size_t most = std::size_t{4} << 20;  // their frames are larger
#else
constexpr std::size_t most = 64 * 1024;
#endif
constexpr std::size_t stack_size = std::max(most, std::size_t{1} << 20);
constexpr int workers = 3;
constexpr unsigned char unused = 0xa5;

struct Host {
    int calls = 0;
    std::size_t most_used = 0;
};

struct Call {
    helibore::Runner::Job job;
    void* context;
    std::int32_t worker;
};

void* begin(void* call) {
    const auto& [job, context, worker] = *static_cast<Call*>(call);
    job(context, worker);
    return nullptr;
}

// Each worker on a stack of its own, filled to see what it uses.
void run(void* of, std::int32_t count, helibore::Runner::Job job, void* context) {
    Host& host = *static_cast<Host*>(of);
    ++host.calls;
    CHECK(count <= workers);
    unsigned char* stacks[workers];
    pthread_t threads[workers];
    Call calls[workers];
    for (std::int32_t w = 0; w < count; ++w) {
        void* mapped = mmap(nullptr, stack_size, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
        CHECK(mapped != MAP_FAILED);
        stacks[w] = static_cast<unsigned char*>(mapped);
        std::memset(stacks[w], unused, stack_size);
        calls[w] = {job, context, w};
        pthread_attr_t attributes;
        pthread_attr_init(&attributes);
        CHECK(pthread_attr_setstack(&attributes, stacks[w], stack_size) == 0);
        CHECK(pthread_create(&threads[w], &attributes, begin, &calls[w]) == 0);
        pthread_attr_destroy(&attributes);
    }
    for (std::int32_t w = 0; w < count; ++w) {
        pthread_join(threads[w], nullptr);
        const unsigned char* first =
            std::find_if(stacks[w], stacks[w] + stack_size, [](auto b) { return b != unused; });
        host.most_used = std::max(host.most_used, static_cast<std::size_t>(stacks[w] + stack_size - first));
        munmap(stacks[w], stack_size);
    }
}

// All that is shared out to threads.
std::vector<std::uint64_t> work(helibore::InstructionSet set, int threads) {
    static const Hole hole = oval_hole(20'000, 100.0, 12.0);
    helibore::Settings settings{
        .bit_diameter = 0.216, .sectors = 64, .pitch = 0.05, .threads = threads, .instruction_set = set};
    hole.all().validate(threads);
    helibore::Wall wall(settings);
    wall.append(hole.all());
    std::vector<std::uint64_t> all = bits(wall);
    const auto add = [&](std::span<const double> values) {
        for (const double value : values) all.push_back(value == value ? std::bit_cast<std::uint64_t>(value) : 0);
    };
    const auto samples = wall.samples();
    const std::span<const double> channel(samples[2]);
    add(wall.interpolate_samples({&channel, 1}, threads)[0]);
    const std::vector<double> radius = wall.radius();
    const auto some = [](std::vector<double> column) {
        column.resize(2000);
        return column;
    };
    const std::vector<double> depth = some(wall.depth()), toolface = some(wall.toolface()), trial = some(radius);
    const std::vector<double> box(2000, 0.02), nuggets = {0.5};
    settings.estimator = helibore::Estimator::kriging;
    settings.kriging_range = 0.4;
    settings.neighbors = 64;
    settings.pitch = 0.1;  // fewer vertices
    add(helibore::estimate_at({samples[0], samples[1], samples[2]}, {depth, toolface, trial, box, box}, settings,
                              nuggets)
            .radius);
    helibore::Wall kriged(settings);
    kriged.append(hole.rows(0, 1000));
    add(kriged.radius());
    settings = {.bit_diameter = 0.216,
                .pitch = 0.1,
                .neighbors = 256,
                .window = 3000,
                .power = 0.7,
                .sigma = true,
                .threads = threads};
    helibore::Wall crowded(settings);
    crowded.append(hole.rows(0, 1000));
    add(crowded.radius());
    const helibore::HelixVertices vertices{
        .start_depth = wall.start_depth(), .pitch = 0.05, .sectors = 64, .count = wall.size()};
    add(helibore::angular_gaps(vertices, {samples[0], samples[1]}, 0.1, threads));
    const helibore::HelixRadii helix{.start_depth = wall.start_depth(), .pitch = 0.05, .sectors = 64, .radius = radius};
    const double stations[] = {90.0, 105.0, 140.0}, inclination[] = {10.0, 30.0, 35.0}, azimuth[] = {20.0, 60.0, 61.0};
    const helibore::Path path{helibore::Survey(stations, inclination, azimuth)};
    for (const auto& vertex : helibore::surface_of(helix, path, threads).vertices) add(vertex);
    const helibore::TurnLogs logs = helibore::turn_logs({.sectors = 64, .radius = radius}, threads);
    for (const auto* column : {&logs.c1, &logs.inscribed_diameter, &logs.enclosing_diameter, &logs.rugosity})
        add(*column);
    return all;
}

}  // namespace

int main() {
    Host host;
    for (const auto set :
         {helibore::InstructionSet::plain, helibore::InstructionSet::avx2, helibore::InstructionSet::avx512}) {
        try {
            static_cast<void>(helibore::Wall({.bit_diameter = 0.216, .instruction_set = set}));
        } catch (const helibore::InputError&) {
            continue;  // this processor has none
        }
        const std::vector<std::uint64_t> expected = work(set, workers);
        const int calls = host.calls;
        {
            const helibore::UseRunner use({run, &host});
            CHECK(work(set, workers) == expected);
            CHECK(host.calls > calls + 5);
        }
        const int ended = host.calls;
        static_cast<void>(work(set, workers));
        CHECK(host.calls == ended);
    }
    CHECK(host.most_used <= most);
    std::cout << "a worker used " << host.most_used << " bytes of stack\n";
    return failures();
}
#else
int main() {
    return 0;
}
#endif
