#include <belvedere.h>
#include <stdio.h>

int main(void) {
    bv_node *node;
    bv_command_publisher *motors;
    bv_subscriber *core;
    const bv_motor_power off = {0};
    if (bv_node_open(NULL, "motors-off", &node) != BV_STATUS_OK ||
        bv_subscribe(node, "mobile_base/sensors/core", &core) != BV_STATUS_OK ||
        bv_subscriber_wait(core, 5000) != BV_STATUS_OK ||  // until the robot has started
        bv_command_open(node, "mobile_base/commands/motor_power", BV_KIND_MOTOR_POWER, &motors) != BV_STATUS_OK ||
        bv_command_send(motors, &off, sizeof off) != BV_STATUS_OK) {
        fprintf(stderr, "%s\n", bv_last_error());
        return 1;
    }
    for (int count = 0; count < 30; ++count) {  // until the command has arrived and the wheels stand still
        bv_frame *frame;
        if (bv_subscriber_wait(core, 5000) != BV_STATUS_OK) return 1;
        if (bv_subscriber_take(core, &frame) != BV_STATUS_OK) continue;
        const bv_core_sensors *state = (const bv_core_sensors *)bv_frame_get_payload(frame);
        printf("left wheel at %u ticks\n", state->left_encoder);
        bv_frame_release(frame);
    }
    bv_command_close(motors);
    bv_subscriber_close(core);
    bv_node_close(node);
}
