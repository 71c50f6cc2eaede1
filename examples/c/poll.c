#include <belvedere.h>
#include <poll.h>
#include <stdio.h>

int main(void) {
    const char *topics[] = {"image_raw", "scan"};
    bv_node *node;
    bv_subscriber *subscribers[2];
    struct pollfd fds[2] = {{.events = POLLIN}, {.events = POLLIN}};
    if (bv_node_open(NULL, "poll-c", &node) != BV_STATUS_OK) return 1;
    for (int i = 0; i < 2; ++i)
        if (bv_subscribe(node, topics[i], &subscribers[i]) != BV_STATUS_OK ||
            bv_subscriber_fd(subscribers[i], &fds[i].fd) != BV_STATUS_OK) return 1;
    int count = 0;
    while (count < 20 && poll(fds, 2, 5000) > 0)
        for (int i = 0; i < 2; ++i) {
            bv_frame *frame;
            if (!(fds[i].revents & POLLIN)) continue;
            while (bv_subscriber_take(subscribers[i], &frame) == BV_STATUS_OK) {
                printf("%s at %llu ns\n", topics[i], (unsigned long long)bv_frame_get_header(frame)->stamp_ns);
                bv_frame_release(frame);
                ++count;
            }
        }
    if (count < 20) fprintf(stderr, "no frame for 5 s; start a simulator (belvedere run)\n");
    for (int i = 0; i < 2; ++i) bv_subscriber_close(subscribers[i]);
    bv_node_close(node);
    return count < 20;
}
