// Threads that walls hand on to each other.
//
//     const auto crews = std::make_shared<helibore::Crews>();
//     helibore::Wall first({.bit_diameter = 0.216, .threads = 4}, nullptr, crews);   // the threads of its calls ...
//     helibore::Wall second({.bit_diameter = 0.216, .threads = 4}, nullptr, crews);  // ... serve those of the next
//
// To start a thread takes as long as to search some five hundred vertices. So the threads of a call look for further
// work a little longer: 50 us, and a tenth of the time that they have lately worked, 1 ms at most; then they end. They
// run on the processors and with the priority of the caller that started them, so callers that differ there have Crews
// of their own. Nobody waits for them to end: the library must stay loaded a moment longer than its last call.
#pragma once

#include <memory>
#include <mutex>
#include <vector>

namespace helibore {

class Crew;

// May be shared by walls of several threads: of calls at one time, each has the threads that its wall asks for.
class Crews {
  public:
    Crews();
    ~Crews();
    Crews(const Crews&) = delete;
    Crews& operator=(const Crews&) = delete;

  private:
    friend class Shift;
    std::unique_ptr<Crew> take();
    void keep(std::unique_ptr<Crew> crew) noexcept;

    std::mutex lock_;
    std::vector<std::unique_ptr<Crew>> idle_;
    long process_;  // whose threads they are
};

}  // namespace helibore
