// A library that uses helibore on four threads is loaded, called and unloaded a thousand times. Its symbols are hidden
// (unload_library.map): a unique symbol of the C++ library would keep it in memory.
#include <dlfcn.h>

#include "check.hpp"

int main() {
    long quads = 0;
    for (int i = 0; i < static_cast<int>(1000 / reduced) && failures() == 0; ++i) {
        void* library = dlopen(UNLOAD_LIBRARY, RTLD_NOW | RTLD_LOCAL);
        if (!library) {
            std::cerr << dlerror() << "\n";
            return 1;
        }
        const auto rebuild = reinterpret_cast<long (*)()>(dlsym(library, "rebuild"));
        const long found = rebuild();
        if (i == 0) quads = found;
        CHECK(found > 10000 && found == quads);
        CHECK(dlclose(library) == 0);
        CHECK(!dlopen(UNLOAD_LIBRARY, RTLD_NOW | RTLD_NOLOAD));
    }
    return failures();
}
