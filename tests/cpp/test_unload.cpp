// The shared library is loaded, called on four threads and unloaded a thousand times, also after a fork: it is
// unmapped each time, and the memory of the process does not grow. Two versions of it work in one process.
#include <dlfcn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <fstream>

#include "check.hpp"
#include "helibore/helibore.h"
#include "hole.hpp"

namespace {

const Hole& hole() {
    static const Hole made = oval_hole(6000, 100.0, 17.0);
    return made;
}

template <class Function>
Function* symbol(void* library, const char* name) {
    return reinterpret_cast<Function*>(dlsym(library, name));
}
#define SYMBOL(library, name) symbol<decltype(name)>(library, #name)

// Rebuilds a hole with the functions of one library; returns its number of quads.
std::int64_t rebuild(void* library) {
    hb_settings settings = {};
    settings.size = sizeof settings;
    CHECK(SYMBOL(library, hb_settings_init)(&settings) == HB_OK);
    settings.bit_diameter = 0.216;
    settings.threads = 4;
    std::int64_t wall = 0, vertices = 0, quads = 0, turns = 0;
    CHECK(SYMBOL(library, hb_wall_create)(&settings, &wall) == HB_OK);
    const Hole& h = hole();
    CHECK(SYMBOL(library, hb_wall_append)(wall, std::ssize(h.depth), h.depth.data(), h.toolface.data(), h.radius.data(),
                                          h.time.data(), nullptr) == HB_OK);
    hb_wall_state state = {};
    state.size = sizeof state;
    CHECK(SYMBOL(library, hb_wall_get)(wall, &state) == HB_OK);
    CHECK(SYMBOL(library, hb_wall_surface)(wall, 0, 0, state.vertices, &vertices, nullptr, nullptr, &quads, nullptr) ==
          HB_BUFFER_TOO_SMALL);
    CHECK(SYMBOL(library, hb_wall_logs)(wall, 11, &turns, nullptr) == HB_BUFFER_TOO_SMALL);
    return quads;  // the wall stays open: it ends with the library
}

void* load(const char* path) {
    void* library = dlopen(path, RTLD_NOW | RTLD_LOCAL);
    if (!library) fail(__FILE__, __LINE__, dlerror());
    return library;
}

long resident_pages() {
    long size = 0, resident = 0;
    std::ifstream("/proc/self/statm") >> size >> resident;
    return resident;
}

void load_and_unload(int times) {
    std::int64_t quads = 0;
    long pages = 0;
    for (int i = 0; i < times && failures() == 0; ++i) {
        void* library = load(HELIBORE_LIBRARY);
        if (!library) return;
        const std::int64_t found = rebuild(library);
        if (i == 0) quads = found;
        CHECK(found > 10000 && found == quads);
        CHECK(dlclose(library) == 0);
        CHECK(!dlopen(HELIBORE_LIBRARY, RTLD_NOW | RTLD_NOLOAD));
        if (i == times / 5) pages = resident_pages();
    }
    CHECK(resident_pages() <= pages + 256);  // a megabyte: how threads fall on the arenas of malloc
}

void in_a_child() {
    const pid_t child = fork();
    if (child == 0) {
        load_and_unload(10);
        _exit(failures());
    }
    int status = -1;
    CHECK(waitpid(child, &status, 0) == child && status == 0);
}

void two_versions() {
    void* one = dlopen(HELIBORE_LIBRARY, RTLD_NOW | RTLD_GLOBAL);
    void* other = dlopen(OTHER_VERSION, RTLD_NOW | RTLD_GLOBAL);
    CHECK(one && other && one != other);
    CHECK(SYMBOL(one, hb_wall_create) != SYMBOL(other, hb_wall_create));
    const std::int64_t quads = rebuild(one);
    CHECK(quads == rebuild(other) && quads == rebuild(one));
    CHECK(dlvsym(RTLD_DEFAULT, "hb_version", "HELIBORE_0.1") == dlsym(one, "hb_version"));
    CHECK(dlvsym(RTLD_DEFAULT, "hb_version", "HELIBORE_other") == dlsym(other, "hb_version"));
    CHECK(dlclose(one) == 0 && dlclose(other) == 0);
}

}  // namespace

int main() {
    load_and_unload(static_cast<int>(1000 / reduced));
    in_a_child();
    two_versions();
    return failures();
}
