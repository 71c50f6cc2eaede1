"""Rewrites a recording with the official writer, with chunks compressed by Zstandard: python compress.py FROM TO."""

import sys

from mcap.reader import NonSeekingReader, make_reader
from mcap.writer import CompressionType, Writer

source, target = sys.argv[1:]
with open(source, "rb") as read, open(target, "wb") as written:
    reader = make_reader(read)
    header, summary = reader.get_header(), reader.get_summary()
    writer = Writer(written, compression=CompressionType.ZSTD, chunk_size=1 << 20)
    writer.start(header.profile, header.library)
    for attachment in reader.iter_attachments():
        writer.add_attachment(
            attachment.create_time, attachment.log_time, attachment.name, attachment.media_type, attachment.data
        )
    for metadata in reader.iter_metadata():
        writer.add_metadata(metadata.name, metadata.metadata)
    schemas = {
        schema.id: writer.register_schema(schema.name, schema.encoding, schema.data)
        for schema in summary.schemas.values()
    }
    channels = {
        channel.id: writer.register_channel(
            channel.topic, channel.message_encoding, schemas[channel.schema_id], channel.metadata
        )
        for channel in summary.channels.values()
    }
    read.seek(0)
    count = 0
    # In the order of the file: a frame comes after the message that has its payload.
    for _, channel, message in NonSeekingReader(read).iter_messages(log_time_order=False):
        writer.add_message(
            channels[channel.id], message.log_time, message.data, message.publish_time, message.sequence
        )
        count += 1
    writer.finish()
print(f"{count} messages rewritten by the official writer, with zstd")
