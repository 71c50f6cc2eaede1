# find_package(belvedere_ros CONFIG) defines the target belvedere_ros::belvedere_ros, for nodelets that receive frames
# without a copy.
include(CMakeFindDependencyMacro)
find_dependency(belvedere CONFIG)
include("${CMAKE_CURRENT_LIST_DIR}/belvedere_ros-targets.cmake")
