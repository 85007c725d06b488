"""A run's file written anew by the mcap library's own writer, as another program would write it."""

from __future__ import annotations

from pathlib import Path

from mcap.reader import make_reader
from mcap.writer import CompressionType, Writer

from twin.archive import schemas


def rewrite(source: Path, target: Path, compression: CompressionType, chunked: bool) -> None:
    """Copy a run with the library's own writer, every message packed anew with its zeros left out."""
    with source.open("rb") as stream:
        writer = Writer(str(target), compression=compression, use_chunking=chunked, chunk_size=3000)
        writer.start(profile="twin", library="another program")
        reader = make_reader(stream)
        for a in reader.iter_attachments():
            writer.add_attachment(a.create_time, a.log_time, a.name, a.media_type, a.data)
        metadata = list(reader.iter_metadata())
        for entry in metadata[:2]:
            writer.add_metadata(entry.name, entry.metadata)
        channels = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            if channel.topic not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.topic] = writer.register_channel(channel.topic, channel.message_encoding, number)
            own = schemas.embedded_class(schema.data, schema.name).FromString(message.data)
            data = own.SerializeToString()
            writer.add_message(channels[channel.topic], message.log_time, data, message.publish_time)
        writer.add_metadata(metadata[2].name, metadata[2].metadata)
        writer.finish()
