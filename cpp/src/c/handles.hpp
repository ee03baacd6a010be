// Handles and errors of the C interface: a number stands for an object, and a status with a text for an exception.
//
// The table of handles and each thread's error text are the only state of the library outside the host's objects. A
// number is never used again, so the use of a closed handle is an error, not an access to freed memory. A call in
// progress keeps its object alive.
#pragma once

#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "base/locks.hpp"
#include "base/messages.hpp"
#include "helibore/error.hpp"
#include "helibore/helibore.h"
#include "helibore/live.hpp"
#include "helibore/preparation.hpp"
#include "helibore/wits.hpp"

namespace helibore::c {

struct WallHandle {
    static constexpr const char* kind = "a wall";
    std::shared_ptr<const Wall> read;
    std::shared_ptr<Wall> append;  // null for the wall of a live well
    std::mutex lock;
    std::vector<Range> ranges;  // of the last append
};

struct PathHandle {
    static constexpr const char* kind = "a path";
    Path path;
};

struct LiveHandle {
    static constexpr const char* kind = "a live well";
    explicit LiveHandle(const LiveSettings& settings) : live(settings) {}
    Live live;
    std::mutex lock;
    Update last;  // of the last poll
};

struct ParserHandle {
    static constexpr const char* kind = "a WITS parser";
    wits::Parser parser;
    std::mutex lock;
    wits::Batch last;  // of the last feed
};

struct PreparedHandle {
    static constexpr const char* kind = "a prepared log";
    Prepared prepared;
};

using Object = std::variant<std::shared_ptr<WallHandle>, std::shared_ptr<PathHandle>, std::shared_ptr<LiveHandle>,
                            std::shared_ptr<ParserHandle>, std::shared_ptr<PreparedHandle>>;

class Handles {
  public:
    std::int64_t open(Object object);
    void close(std::int64_t handle);
    void close_all();
    Object find(std::int64_t handle) const;  // throws InputError

  private:
    mutable std::mutex lock_;
    std::unordered_map<std::int64_t, Object> objects_;
    std::int64_t last_ = 0;
};

Handles& handles();

template <class T>
std::shared_ptr<T> find(const char* name, std::int64_t handle) {
    const Object object = handles().find(handle);
    if (const auto* found = std::get_if<std::shared_ptr<T>>(&object)) return *found;
    throw InputError(name, std::string("must be the handle of ") + T::kind, std::to_string(handle));
}

// The error of a call whose output does not fit into the host's arrays.
struct BufferTooSmall : InputError {
    using InputError::InputError;
};

// Returns the status of the exception being handled, and stores its text for hb_last_error.
std::int32_t status_of_exception() noexcept;
void clear_error() noexcept;

// Runs the body of a C function and returns its status. No exception leaves this function.
template <class Body>
std::int32_t guarded(const Body& body) noexcept {
    try {
        body();
        clear_error();
        return HB_OK;
    } catch (...) {
        return status_of_exception();
    }
}

inline void require_pointer(const char* name, const void* pointer) {
    if (!pointer) throw InputError(name, "must not be null");
}

// Returns `size` values of a host's array, which may be null only if `size` is 0.
template <class T>
std::span<T> array(const char* name, T* first, std::int64_t size) {
    if (size > 0) require_pointer(name, first);
    return {first, static_cast<std::size_t>(size)};
}

inline void require_count(std::int64_t n) {
    if (n < 0) throw InputError("n", "must be 0 or more", std::to_string(n));
}

// Writes to each count the number of values that is needed. Throws BufferTooSmall if a count was less than that.
void require_room(std::initializer_list<std::int64_t*> counts, std::initializer_list<std::int64_t> needed);

// The size of a struct in the first header that had it. Later headers add members at its end.
template <class Struct>
inline constexpr std::size_t first_size = sizeof(Struct);
template <>
inline constexpr std::size_t first_size<hb_settings> = 136;

// Returns the size of the struct in the header of the host. Throws InputError if it is older than the first header or
// newer than this library.
template <class Struct>
std::size_t require_struct(const char* name, const Struct* given) {
    require_pointer(name, given);
    const std::size_t size = given->size;
    if (size >= first_size<Struct> && size <= sizeof(Struct)) return size;
    const std::string most = std::to_string(sizeof(Struct)) + ", as in helibore.h of version " HELIBORE_VERSION;
    throw InputError(std::string(name) + ".size",
                     first_size<Struct> == sizeof(Struct)
                         ? "must be " + most
                         : "must lie in " + std::to_string(first_size<Struct>) + " to " + most,
                     std::to_string(size));
}

// Returns a copy of the host's struct; members that its header lacks have the values of `defaults`.
template <class Struct>
Struct taken(const char* name, const Struct* given, Struct defaults) {
    const std::size_t size = require_struct(name, given);
    std::memcpy(&defaults, given, size);
    return defaults;
}

// Fills the members that the host's header has.
template <class Struct>
void give(const char* name, Struct* given, Struct values) {
    const std::size_t size = require_struct(name, given);
    values.size = static_cast<std::uint32_t>(size);
    std::memcpy(given, &values, size);
}

}  // namespace helibore::c
