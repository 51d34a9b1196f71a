# The libraries for other programs: find_package(ballpiston COMPONENTS client core), and pkg-config's
# ballpiston-client and ballpiston-core. Their headers are installed below include/ballpiston.
include(CMakePackageConfigHelpers)

# The headers below FOLDER become <ballpiston/NAME/...>. Further arguments are the headers, relative
# to FOLDER, or patterns of file(GLOB_RECURSE).
function(install_headers folder name component)
  list(JOIN ARGN "|" headers)
  install(CODE "
    set(ballpiston_folder \"${folder}\")
    set(ballpiston_headers \"${headers}\")
    set(ballpiston_destination \"${CMAKE_INSTALL_INCLUDEDIR}/ballpiston/${name}\")"
    COMPONENT ${component})
  install(SCRIPT ${PROJECT_SOURCE_DIR}/cmake/install_headers.cmake COMPONENT ${component})
endfunction()

file(RELATIVE_PATH libdir_to_includedir ${CMAKE_INSTALL_FULL_LIBDIR} ${CMAKE_INSTALL_FULL_INCLUDEDIR})
set(package_folder ${CMAKE_INSTALL_LIBDIR}/cmake/ballpiston)

# The library is the target ballpiston::COMPONENT for other programs. Further arguments are the
# libraries that it needs and that are installed with it. All can be linked into a shared library.
function(install_library target component)
  foreach(library IN LISTS target ARGN)
    string(REPLACE ballpiston_ "" name ${library})
    set_target_properties(${library} PROPERTIES EXPORT_NAME ${name} POSITION_INDEPENDENT_CODE ON)
    # Without this option the compiler inlines no function that a shared library exports.
    target_compile_options(${library} PRIVATE -fno-semantic-interposition)
    target_compile_features(${library} PUBLIC cxx_std_20)
    target_include_directories(${library} INTERFACE $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>)
  endforeach()
  install(TARGETS ${target} ${ARGN} EXPORT ballpiston_${component} ARCHIVE)
  install(EXPORT ballpiston_${component} NAMESPACE ballpiston:: FILE ${component}.cmake
    DESTINATION ${package_folder})
  configure_file(cmake/ballpiston-${component}.pc.in ballpiston-${component}.pc @ONLY)
  install(FILES ${PROJECT_BINARY_DIR}/ballpiston-${component}.pc
    DESTINATION ${CMAKE_INSTALL_LIBDIR}/pkgconfig)
endfunction()

# The linker may take the program's copy of an inline function: it has to have the same bits.
# nvcc does not know the option.
target_compile_options(ballpiston_core INTERFACE
  $<INSTALL_INTERFACE:$<$<COMPILE_LANGUAGE:C,CXX>:-ffp-contract=off>>)
install_library(ballpiston_core core)
install_headers(${PROJECT_SOURCE_DIR}/core core core *.h)
set(components core)

if(NOT BALLPISTON_CORE_ONLY)
  install_library(ballpiston_client client ballpiston_proto)
  install_headers(${PROJECT_SOURCE_DIR}/client/library client client
    channel.h
    channel_security.h
    client.h
    error_text.h
    job_watch.h
    local_server.h
    request_id.h)
  install_headers(${PROJECT_BINARY_DIR}/proto/generated/ballpiston/v1 v1 client *.pb.h)
  install_headers(${PROJECT_BINARY_DIR}/proto/generated/google/rpc google/rpc client *.pb.h)
  install(DIRECTORY proto/ballpiston/v1 DESTINATION ${CMAKE_INSTALL_DATADIR}/ballpiston/proto/ballpiston)
  install(DIRECTORY proto/google DESTINATION ${CMAKE_INSTALL_DATADIR}/ballpiston/proto)
  list(APPEND components client)
endif()

configure_package_config_file(cmake/ballpistonConfig.cmake.in ballpistonConfig.cmake
  INSTALL_DESTINATION ${package_folder})
# A program asks for the version that it was written for. Before 1.0.0 a minor version may change
# what programs use.
if(PROJECT_VERSION_MAJOR EQUAL 0)
  set(compatibility SameMinorVersion)
else()
  set(compatibility SameMajorVersion)
endif()
write_basic_package_version_file(ballpistonConfigVersion.cmake COMPATIBILITY ${compatibility})
install(FILES ${PROJECT_BINARY_DIR}/ballpistonConfig.cmake ${PROJECT_BINARY_DIR}/ballpistonConfigVersion.cmake
  DESTINATION ${package_folder})
