// Runs a fuzz target. With HELIBORE_LIBFUZZER (clang), libFuzzer provides main and looks for inputs that reach new
// code; without it, inputs are random bytes from seeds. Both take the same options:
//
//     fuzz_wall -runs=2000 -seed=1            tries 2,000 inputs
//     fuzz_wall --seconds=600                 tries inputs for 600 seconds of processor time
//     fuzz_wall crash-...                     tries the inputs in these files; a failure writes such a file
#include <ctime>
#include <limits>

#include "input.hpp"

namespace {

unsigned long long number = 0;  // of inputs
double most_seconds = std::numeric_limits<double>::infinity();

double processor_seconds() {
    return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

void print_effort() {
    std::printf("%llu inputs, %.0f s of processor time\n", number, processor_seconds());
    std::fflush(stdout);
}

std::optional<std::string> value_of(const char* argument, std::string_view name) {
    if (!std::string_view(argument).starts_with(name)) return std::nullopt;
    return argument + name.size();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* bytes, std::size_t size) {
    fuzz(Input(bytes, size));
    ++number;
#ifdef HELIBORE_LIBFUZZER
    if (processor_seconds() >= most_seconds) {  // libFuzzer itself knows only the clock on the wall
        print_effort();
        std::_Exit(0);
    }
#endif
    return 0;
}

#ifdef HELIBORE_LIBFUZZER
extern "C" int LLVMFuzzerInitialize(const int* count, char* const* const* arguments) {
    for (int i = 1; i < *count; ++i)
        if (const auto seconds = value_of((*arguments)[i], "--seconds=")) most_seconds = std::stod(*seconds);
    return 0;
}
#else
#include <csignal>
#include <fstream>
#include <iterator>
#include <random>

// A sanitizer that finds something aborts, so that the input is written.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
    return "abort_on_error=1";
}
extern "C" const char* __ubsan_default_options();
extern "C" const char* __ubsan_default_options() {
    return "abort_on_error=1:print_stacktrace=1";
}

namespace {

std::vector<std::uint8_t> current;
unsigned long long seed = 1;

void write_input(int) {
    char name[64];
    std::snprintf(name, sizeof name, "crash-%llu-%llu", seed, number);
    if (std::FILE* file = std::fopen(name, "wb")) {
        std::fwrite(current.data(), 1, current.size(), file);
        std::fclose(file);
    }
    std::fprintf(stderr, "the input is in %s\n", name);
    std::signal(SIGABRT, SIG_DFL);
    std::abort();
}

// Random bytes; in some inputs many are small or equal, so that first choices come up often.
void make_input() {
    std::seed_seq of_both{seed, number};
    std::mt19937_64 random(of_both);
    constexpr std::size_t sizes[] = {16, 64, 256, 1024};
    current.resize(1 + random() % sizes[random() % 4]);
    const std::uint64_t kind = random() % 4;
    for (std::uint8_t& byte : current) {
        const std::uint64_t drawn = random();
        byte = static_cast<std::uint8_t>(kind == 0 && drawn >> 32 & 1 ? 0 : kind == 1 ? drawn % 16 : drawn);
    }
}

}  // namespace

int main(int count, char** arguments) {
    unsigned long long runs = std::numeric_limits<unsigned long long>::max();
    std::signal(SIGABRT, write_input);
    std::signal(SIGSEGV, write_input);
    std::signal(SIGFPE, write_input);
    bool files = false;
    for (int i = 1; i < count; ++i) {
        if (const auto runs_text = value_of(arguments[i], "-runs=")) {
            runs = std::stoull(*runs_text);
        } else if (const auto seed_text = value_of(arguments[i], "-seed=")) {
            seed = std::stoull(*seed_text);
        } else if (const auto seconds = value_of(arguments[i], "--seconds=")) {
            most_seconds = std::stod(*seconds);
        } else {
            std::ifstream file(arguments[i], std::ios::binary);
            if (!file) {
                std::fprintf(stderr, "%s: cannot be read\n", arguments[i]);
                return 2;
            }
            current.assign(std::istreambuf_iterator<char>(file), {});
            LLVMFuzzerTestOneInput(current.data(), current.size());
            files = true;
        }
    }
    while (!files && number < runs && processor_seconds() < most_seconds) {
        make_input();
        LLVMFuzzerTestOneInput(current.data(), current.size());
    }
    print_effort();
}
#endif
