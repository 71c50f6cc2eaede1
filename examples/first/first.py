import belvedere

with belvedere.Node("first-python") as node, node.subscribe("image_raw") as camera:
    for count, frame in enumerate(camera.frames(timeout=5.0), 1):
        height, width, _ = frame.array.shape  # a view of the memory that the simulator wrote
        print(f"{width} x {height}, first pixel", *frame.array[0, 0])
        if count == 10:
            break
