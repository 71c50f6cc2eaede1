#include <belvedere.h>
#include <stdio.h>

int main(void) {
    bv_node *node;
    bv_subscriber *camera;
    if (bv_node_open(NULL, "first-c", &node) != BV_STATUS_OK ||
        bv_subscribe(node, "image_raw", &camera) != BV_STATUS_OK) {
        fprintf(stderr, "%s\n", bv_last_error());
        return 1;
    }
    int count = 0;
    while (count < 10 && bv_subscriber_wait(camera, 5000) == BV_STATUS_OK) {
        bv_frame *frame;
        if (bv_subscriber_take(camera, &frame) != BV_STATUS_OK) continue;
        const bv_frame_header *header = bv_frame_get_header(frame);
        const uint8_t *pixels = bv_frame_get_payload(frame);  // in place: the memory that the simulator wrote
        printf("%u x %u, first pixel %d %d %d\n", header->width, header->height, pixels[0], pixels[1], pixels[2]);
        bv_frame_release(frame);
        ++count;
    }
    if (count < 10) fprintf(stderr, "no image for 5 s; start a simulator (belvedere run)\n");
    bv_subscriber_close(camera);
    bv_node_close(node);
    return count < 10;
}
