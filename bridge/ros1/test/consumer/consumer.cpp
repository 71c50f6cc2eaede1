// Prints the MD5 sums of a message and of a service; the test is that the compiler finds them.
#include <gazebo_msgs/SpawnModel.h>
#include <kobuki_msgs/AutoDockingAction.h>
#include <kobuki_msgs/SensorState.h>
#ifdef HAS_DOCKED
#include <consumer/Docked.h>
static_assert(consumer::Docked::_seen_type::FAR_RIGHT == 32);
#endif

#include <cstdio>

int main() {
    std::printf("%s %s\n", ros::message_traits::md5sum<kobuki_msgs::AutoDockingAction>(), ros::service_traits::md5sum<gazebo_msgs::SpawnModel>());
}
