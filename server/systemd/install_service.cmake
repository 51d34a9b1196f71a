cmake_policy(SET CMP0054 NEW)  # a quoted word is a word, never the name of a variable
# Run by `cmake --install`; CMakeLists.txt sets the variables ballpiston_*.
set(bin "${ballpiston_bindir}")
set(etc "${ballpiston_sysconfdir}")
if(CMAKE_INSTALL_PREFIX STREQUAL "/usr" AND etc STREQUAL "etc")
  set(etc /etc)
endif()
cmake_path(ABSOLUTE_PATH bin BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
cmake_path(ABSOLUTE_PATH etc BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")

function(install_with_paths file destination name)
  file(READ "${ballpiston_source}/${file}" text)
  string(REPLACE "/usr/bin" "${bin}" text "${text}")
  string(REPLACE "/etc/ballpiston" "${etc}/ballpiston" text "${text}")
  message(STATUS "Installing: $ENV{DESTDIR}${destination}/${name}")
  file(WRITE "$ENV{DESTDIR}${destination}/${name}" "${text}")
  file(CHMOD "$ENV{DESTDIR}${destination}/${name}"
    PERMISSIONS OWNER_READ OWNER_WRITE GROUP_READ WORLD_READ)
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${destination}/${name}")
  set(CMAKE_INSTALL_MANIFEST_FILES "${CMAKE_INSTALL_MANIFEST_FILES}" PARENT_SCOPE)
endfunction()

install_with_paths(ballpistond.service "${CMAKE_INSTALL_PREFIX}/lib/systemd/system"
  ballpistond.service)
install_with_paths(ballpistond.sysusers "${CMAKE_INSTALL_PREFIX}/lib/sysusers.d" ballpistond.conf)
# The laboratory edits this file, so an upgrade keeps it.
if(NOT EXISTS "$ENV{DESTDIR}${etc}/ballpiston/ballpistond.conf")
  install_with_paths(ballpistond.conf "${etc}/ballpiston" ballpistond.conf)
endif()
