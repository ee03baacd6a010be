// The runner of each thread.
#include "base/threads.hpp"

#include <utility>

namespace helibore {

namespace {

constinit thread_local Runner runner;

}  // namespace

Runner& runner_of_this_thread() {
    return runner;
}

UseRunner::UseRunner(const Runner& given) : before_(std::exchange(runner, given)) {}
UseRunner::~UseRunner() {
    runner = before_;
}

}  // namespace helibore
