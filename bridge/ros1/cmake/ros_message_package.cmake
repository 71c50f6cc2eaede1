# Generates message packages, C++ headers and Python modules, with ROS's own generators and without catkin.

include(CMakePackageConfigHelpers)

# ros_message_package(<package> [DEPENDS <package>...])
#
# Builds the package in the folder of that name from its package.xml, msg/*.msg, srv/*.srv and action/*.action. DEPENDS
# names the packages whose messages are fields of its own, including indirect ones. Link with the library
# <package>_headers to include <package>/Message.h.
#
# Installs headers, Python modules, the definitions, which rosmsg and rossrv read, and the files for find_package and
# catkin. In a catkin workspace, an existing package of that name in ROS or the workspace is used instead; otherwise the
# package is built in the devel space.
function(ros_message_package package)
  cmake_parse_arguments(PARSE_ARGV 1 arg "" "" DEPENDS)
  add_library(${package}_headers INTERFACE)

  set(out "${PROJECT_BINARY_DIR}/messages")
  set(python "${Python3_EXECUTABLE}")
  if(COMMAND catkin_package)
    find_package(${package} QUIET)
    # Belvedere's package under another prefix is for programs without a workspace.
    if(${package}_FOUND AND NOT ${package}_IS_OF_BELVEDERE)
      target_include_directories(${package}_headers SYSTEM INTERFACE ${${package}_INCLUDE_DIRS})
      if(${package}_EXPORTED_TARGETS)
        add_dependencies(${package}_headers ${${package}_EXPORTED_TARGETS})
      endif()
      return()
    endif()
    set(out "${CATKIN_DEVEL_PREFIX}")
    set(python "${PYTHON_EXECUTABLE}")
    set(python_dir "${CATKIN_GLOBAL_PYTHON_DESTINATION}")
  else()
    find_package(Python3 REQUIRED COMPONENTS Interpreter)
    # Debian's Python searches this directory by default if the prefix is /usr/local.
    set(python_dir "lib/python${Python3_VERSION_MAJOR}.${Python3_VERSION_MINOR}/dist-packages")
  endif()

  # Finding the generators with find_package would need catkin.
  _ros_path(gencpp_scripts lib/gencpp gen_cpp.py ros-message-generation)
  _ros_path(genpy_scripts lib/genpy genmsg_py.py ros-message-generation)
  _ros_path(gencpp_share share gencpp/msg.h.template ros-message-generation)
  set(source "${CMAKE_CURRENT_SOURCE_DIR}/${package}")
  set(includes "-I${package}:${source}/msg")
  foreach(dependency IN LISTS arg_DEPENDS)
    string(REPLACE "_" "-" debian "ros-${dependency}")
    _ros_path(${dependency}_share share ${dependency}/msg ${debian})
    list(APPEND includes "-I${dependency}:${${dependency}_share}/${dependency}/msg")
  endforeach()

  file(GLOB definitions CONFIGURE_DEPENDS "${source}/msg/*.msg" "${source}/srv/*.srv")
  # The seven messages of each action are generated now, since the files generated from them must be known.
  file(GLOB actions CONFIGURE_DEPENDS "${source}/action/*.action")
  set(of_actions "${PROJECT_BINARY_DIR}/actions/${package}")
  if(actions)
    _ros_path(genaction_scripts lib/actionlib_msgs genaction.py libactionlib-msgs-dev)
    list(APPEND includes "-I${package}:${of_actions}")
    install(FILES ${actions} DESTINATION share/${package}/action)
  endif()
  foreach(action IN LISTS actions)
    set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS "${action}")
    execute_process(COMMAND "${python}" "${genaction_scripts}/genaction.py" "${action}" -o "${of_actions}"
      OUTPUT_QUIET RESULT_VARIABLE failed)
    if(failed)
      message(FATAL_ERROR "genaction.py made no messages of ${action}")
    endif()
    get_filename_component(name "${action}" NAME_WE)
    foreach(part Action ActionFeedback ActionGoal ActionResult Feedback Goal Result)
      list(APPEND definitions "${of_actions}/${name}${part}.msg")
    endforeach()
  endforeach()
  set(generated)
  file(GENERATE OUTPUT "${out}/${python_dir}/${package}/__init__.py" CONTENT "")
  install(FILES "${out}/${python_dir}/${package}/__init__.py" DESTINATION "${python_dir}/${package}")
  foreach(kind msg srv)
    set(of_kind ${definitions})
    list(FILTER of_kind INCLUDE REGEX "\\.${kind}$")
    if(NOT of_kind)
      continue()
    endif()
    set(headers)
    set(modules)
    set(init)
    foreach(definition IN LISTS of_kind)
      get_filename_component(name "${definition}" NAME_WE)
      set(own_headers "${out}/include/${package}/${name}.h")
      if(kind STREQUAL srv)
        list(APPEND own_headers "${out}/include/${package}/${name}Request.h" "${out}/include/${package}/${name}Response.h")
      endif()
      # Any message may be a field of any other, so each depends on all.
      add_custom_command(OUTPUT ${own_headers}
        COMMAND "${python}" "${gencpp_scripts}/gen_cpp.py" "${definition}" ${includes} -p ${package}
          -o "${out}/include/${package}" -e "${gencpp_share}/gencpp"
        DEPENDS ${definitions} VERBATIM)
      list(APPEND headers ${own_headers})
      list(APPEND modules "${out}/${python_dir}/${package}/${kind}/_${name}.py")
      string(APPEND init "from ._${name} import *\n")
    endforeach()
    set(modules_dir "${python_dir}/${package}/${kind}")
    add_custom_command(OUTPUT ${modules}
      COMMAND "${python}" "${genpy_scripts}/gen${kind}_py.py" ${of_kind} ${includes} -p ${package} -o "${out}/${modules_dir}"
      DEPENDS ${definitions} VERBATIM)
    file(GENERATE OUTPUT "${out}/${modules_dir}/__init__.py" CONTENT "${init}")
    list(APPEND generated ${headers} ${modules})
    install(FILES ${headers} DESTINATION include/${package})
    install(FILES ${modules} "${out}/${modules_dir}/__init__.py" DESTINATION "${modules_dir}")
    install(FILES ${of_kind} DESTINATION share/${package}/${kind})
  endforeach()
  install(FILES "${source}/package.xml" DESTINATION share/${package})

  add_custom_target(${package}_generated ALL DEPENDS ${generated})
  add_dependencies(${package}_headers ${package}_generated)
  target_include_directories(${package}_headers SYSTEM INTERFACE "${out}/include")

  # The path of the definitions relative to the configuration's folder, which other message packages read.
  file(STRINGS "${source}/package.xml" version REGEX "<version>")
  string(REGEX REPLACE ".*<version>(.*)</version>.*" "\\1" version "${version}")
  set(configuration "${PROJECT_BINARY_DIR}/configurations/${package}")
  _message_package_configuration("${configuration}" "\${${package}_DIR}/../msg")
  install(DIRECTORY "${configuration}/" DESTINATION share/${package}/cmake)
  if(COMMAND catkin_package)
    _message_package_configuration("${out}/share/${package}/cmake" "${source}/msg;${of_actions}")
  endif()
endfunction()

# Writes the files that find_package(<package>) and genmsg read into a folder, for ros_message_package() and with its
# variables.
function(_message_package_configuration folder message_dirs)
  configure_file("${CMAKE_CURRENT_SOURCE_DIR}/cmake/message_package-config.cmake.in" "${folder}/${package}Config.cmake" @ONLY)
  file(WRITE "${folder}/${package}-msg-paths.cmake"
    "set(${package}_MSG_INCLUDE_DIRS \"${message_dirs}\")\nset(${package}_MSG_DEPENDENCIES ${arg_DEPENDS})\n")
  write_basic_package_version_file("${folder}/${package}Config-version.cmake" VERSION "${version}" COMPATIBILITY AnyNewerVersion)
endfunction()

# Sets <variable> to the folder that contains <file>: one named <suffix> under some prefix.
function(_ros_path variable suffix file debian)
  find_path(${variable} NAMES ${file} PATH_SUFFIXES ${suffix})
  mark_as_advanced(${variable})
  if(NOT ${variable})
    message(FATAL_ERROR "${suffix}/${file} was not found under any prefix: install ${debian}, or add its prefix to CMAKE_PREFIX_PATH")
  endif()
endfunction()
