// Crews between two calls. Nobody waits for the lock: a call that finds it held has a crew of its own. In a forked
// process it may be held for ever, and the crews there have lost their threads.
#include "helibore/crews.hpp"

#include <new>
#include <utility>

#include "base/threads.hpp"

#if defined(__unix__) || defined(__APPLE__)
#include <unistd.h>
#endif

namespace helibore {
namespace {

long this_process() {
#if defined(__unix__) || defined(__APPLE__)
    return getpid();
#else
    return 0;
#endif
}

}  // namespace

Crews::Crews() : process_(this_process()) {}
Crews::~Crews() = default;

// The one that rested last, whose threads are the likeliest to be there still.
std::unique_ptr<Crew> Crews::take() {
    const std::unique_lock held(lock_, std::try_to_lock);
    if (held && process_ != this_process()) {
        idle_.clear();
        process_ = this_process();
    }
    if (!held || idle_.empty()) return std::make_unique<Crew>();
    std::unique_ptr<Crew> crew = std::move(idle_.back());
    idle_.pop_back();
    return crew;
}

void Crews::keep(std::unique_ptr<Crew> crew) noexcept {
    const std::unique_lock held(lock_, std::try_to_lock);
    if (!held) return;
    try {
        idle_.push_back(std::move(crew));
    } catch (const std::bad_alloc&) {  // then this crew goes
    }
}

Shift::Shift(Crews* crews, int threads) : crews_(crews), crew_(crews ? crews->take() : std::make_unique<Crew>()) {
    crew_->begin(threads);
}

Shift::~Shift() {
    crew_->rest();
    if (crews_) crews_->keep(std::move(crew_));
}

}  // namespace helibore
