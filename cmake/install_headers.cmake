# Run by `cmake --install`; install_libraries.cmake sets the variables ballpiston_*. In this project
# headers are included by their folder, "core/...". For other programs each name begins with
# "ballpiston/", so that it cannot be the name of one of their own headers.
string(REPLACE "|" ";" headers "${ballpiston_headers}")
list(TRANSFORM headers PREPEND "${ballpiston_folder}/")
file(GLOB_RECURSE headers RELATIVE "${ballpiston_folder}" ${headers})
list(FILTER headers EXCLUDE REGEX "-inl\\.h$|_mock\\.grpc\\.pb\\.h$")
cmake_path(ABSOLUTE_PATH ballpiston_destination BASE_DIRECTORY "${CMAKE_INSTALL_PREFIX}")
message(STATUS "Installing: $ENV{DESTDIR}${ballpiston_destination}")
foreach(header IN LISTS headers)
  file(READ "${ballpiston_folder}/${header}" text)
  string(REGEX REPLACE "(#include [\"<])(core/|google/rpc/)" "\\1ballpiston/\\2" text "${text}")
  string(REPLACE "#include \"client/library/" "#include \"ballpiston/client/" text "${text}")
  file(WRITE "$ENV{DESTDIR}${ballpiston_destination}/${header}" "${text}")
  list(APPEND CMAKE_INSTALL_MANIFEST_FILES "${ballpiston_destination}/${header}")
endforeach()
