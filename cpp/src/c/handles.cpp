// The table of handles, and the texts of errors.
#include "c/handles.hpp"

#include <algorithm>
#include <cstring>
#include <new>
#include <stdexcept>
#include <utility>

namespace helibore::c {

namespace {

thread_local char last_error[1024];  // no destructor: a destructor would keep the library loaded until the thread ends

void set_error(const char* text, const char* more = "") noexcept {
    char* end = last_error;
    const auto add = [&](const char* part) {
        const std::size_t room = static_cast<std::size_t>(last_error + sizeof last_error - 1 - end);
        std::size_t size = std::min(std::strlen(part), room);
        while (size > 0 && (part[size] & 0xc0) == 0x80) --size;  // never cuts a character of UTF-8 in two
        std::memcpy(end, part, size);
        end += size;
    };
    add(text);
    add(more);
    *end = '\0';
}

InputError not_open(std::int64_t handle) {
    return {"handle", "is not open", std::to_string(handle)};
}

// Frees what a host has left open when it unloads the library. The table itself stays: other threads may still call
// while the process exits.
struct CloseAtEnd {
    Handles& handles;
    ~CloseAtEnd() { handles.close_all(); }
};

}  // namespace

Handles& handles() {
    alignas(Handles) static unsigned char room[sizeof(Handles)];
    static Handles* const table = new (room) Handles;
    static const CloseAtEnd close_at_end{*table};  // made after the library's other objects, so destroyed first
    return *table;
}

std::int64_t Handles::open(Object object) {
    const std::lock_guard held(lock_);
    objects_.emplace(last_ + 1, std::move(object));
    return ++last_;
}

void Handles::close(std::int64_t handle) {
    const auto closed = [&] {
        const std::lock_guard held(lock_);
        return objects_.extract(handle);
    }();
    if (closed.empty()) throw not_open(handle);
}  // the object is deleted here, without the lock

void Handles::close_all() {
    std::unordered_map<std::int64_t, Object> objects;
    const std::lock_guard held(lock_);
    objects_.swap(objects);
}

Object Handles::find(std::int64_t handle) const {
    const std::lock_guard held(lock_);
    const auto found = objects_.find(handle);
    if (found == objects_.end()) throw not_open(handle);
    return found->second;
}

std::int32_t status_of_exception() noexcept {
    try {
        throw;
    } catch (const BufferTooSmall& error) {
        set_error(error.what());
        return HB_BUFFER_TOO_SMALL;
    } catch (const InputError& error) {
        set_error(error.what());
        return HB_INPUT;
    } catch (const std::bad_alloc&) {
        set_error("out of memory");
        return HB_NO_MEMORY;
    } catch (const std::length_error&) {
        set_error("out of memory");
        return HB_NO_MEMORY;
    } catch (const InternalError& error) {
        set_error(error.what());
    } catch (const std::exception& error) {
        set_error(error.what(), "; this is a bug in helibore");
    } catch (...) {
        set_error("unknown exception; this is a bug in helibore");
    }
    return HB_INTERNAL;
}

void clear_error() noexcept {
    last_error[0] = '\0';
}

void require_room(std::initializer_list<std::int64_t*> counts, std::initializer_list<std::int64_t> needed) {
    bool enough = true;
    std::string given, wanted;
    for (std::size_t i = 0; i < counts.size(); ++i) {
        std::int64_t* const count = counts.begin()[i];
        require_pointer("count", count);
        enough = enough && *count >= needed.begin()[i];
        given.append(i > 0 ? ", " : "").append(std::to_string(*count));
        wanted.append(i > 0 ? ", " : "").append(std::to_string(needed.begin()[i]));
    }
    for (std::size_t i = 0; i < counts.size(); ++i) *counts.begin()[i] = needed.begin()[i];
    if (!enough) throw BufferTooSmall("count", "must be at least " + wanted, given);
}

}  // namespace helibore::c

const char* hb_last_error(void) {
    return helibore::c::last_error;
}
