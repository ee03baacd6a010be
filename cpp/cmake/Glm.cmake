# GLM is the core's vector library, used only inside cpp/src. An installed package wins; otherwise a pinned release is
# fetched, headers only (SOURCE_SUBDIR names a folder that does not exist, so GLM's own CMake never runs).
find_package(glm 0.9.9.8 CONFIG QUIET)
if(NOT glm_FOUND)
  message(STATUS "GLM is not installed (Debian: libglm-dev; Fedora: glm-devel; Homebrew, vcpkg, conda-forge: glm); "
                 "fetching the pinned release, which needs a network")
  include(FetchContent)
  FetchContent_Declare(glm
    URL https://github.com/g-truc/glm/archive/refs/tags/1.0.3.tar.gz
    URL_HASH SHA256=6775e47231a446fd086d660ecc18bcd076531cfedd912fbd66e576b118607001
    SOURCE_SUBDIR do-not-configure)
  FetchContent_MakeAvailable(glm)
  add_library(helibore_glm INTERFACE)
  target_include_directories(helibore_glm SYSTEM INTERFACE ${glm_SOURCE_DIR})
else()
  add_library(helibore_glm INTERFACE)
  get_target_property(helibore_glm_include glm::glm INTERFACE_INCLUDE_DIRECTORIES)
  target_include_directories(helibore_glm SYSTEM INTERFACE ${helibore_glm_include})
endif()
