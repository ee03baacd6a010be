# GLM is the core's vector library: headers only, used only inside cpp/src. If no package of it is installed, CMake
# downloads one fixed release. It tries once, so that on a machine without a network the message about what to install
# comes within seconds.
find_package(glm 0.9.9.8 CONFIG QUIET)
add_library(helibore_glm INTERFACE)
if(glm_FOUND)
  get_target_property(glm_headers glm::glm INTERFACE_INCLUDE_DIRECTORIES)
else()
  set(glm_headers "${CMAKE_CURRENT_BINARY_DIR}/glm-1.0.3")
  if(NOT EXISTS "${glm_headers}/glm/glm.hpp")
    set(glm_archive "${CMAKE_CURRENT_BINARY_DIR}/glm.tar.gz")
    file(DOWNLOAD https://github.com/g-truc/glm/archive/refs/tags/1.0.3.tar.gz "${glm_archive}"
         STATUS glm_status TIMEOUT 60 INACTIVITY_TIMEOUT 10)
    file(SHA256 "${glm_archive}" glm_sum)
    if(NOT glm_sum STREQUAL 6775e47231a446fd086d660ecc18bcd076531cfedd912fbd66e576b118607001)
      file(REMOVE "${glm_archive}")
      list(POP_BACK glm_status glm_reason)
      message(FATAL_ERROR "helibore needs the GLM headers. Install them: apt-get install libglm-dev (Debian, Ubuntu), "
                          "dnf install glm-devel (Fedora), or glm of Homebrew, vcpkg, conda-forge. Downloading them "
                          "failed: ${glm_reason}")
    endif()
    file(ARCHIVE_EXTRACT INPUT "${glm_archive}" DESTINATION "${CMAKE_CURRENT_BINARY_DIR}")
  endif()
endif()
# The headers are reached through a folder that holds nothing else: -isystem /usr/include would break cross builds and
# <cstdlib>.
file(MAKE_DIRECTORY "${CMAKE_CURRENT_BINARY_DIR}/glm-only")
file(CREATE_LINK "${glm_headers}/glm" "${CMAKE_CURRENT_BINARY_DIR}/glm-only/glm" SYMBOLIC)
target_include_directories(helibore_glm SYSTEM INTERFACE "${CMAKE_CURRENT_BINARY_DIR}/glm-only")
