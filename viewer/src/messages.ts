// Messages in a stream of bytes, each preceded by its length: see src/view/pipe.rs.

/** Yields each message of a stream, in separate memory, until the stream ends. */
export async function* messages(stream: ReadableStream<Uint8Array>): AsyncGenerator<ArrayBuffer> {
  const reader = stream.getReader();
  const head = new Uint8Array(4);
  /** The buffer that is being filled (the length of a message, or the message), and the number of bytes in it. */
  let [target, filled] = [head, 0];
  for (;;) {
    // The stream ends with the connection, whether or not that is an error.
    const { value } = await reader.read().catch(() => ({ value: undefined }));
    if (value === undefined) return;
    for (let at = 0; at < value.length; ) {
      const count = Math.min(value.length - at, target.length - filled);
      target.set(value.subarray(at, at + count), filled);
      [at, filled] = [at + count, filled + count];
      if (filled < target.length) continue;
      if (target === head) {
        target = new Uint8Array(new DataView(head.buffer).getUint32(0, true));
      } else {
        yield target.buffer;
        target = head;
      }
      filled = 0;
    }
  }
}
