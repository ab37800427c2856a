"""Reads journals as the program writes them (core/session/journal.h): records with checksums."""

import struct
import zlib


def blocks(path):
    """Returns the bytes of each complete record in the file."""
    data, place = path.read_bytes(), 0
    while place + 16 <= len(data):
        word, checksum, length = struct.unpack_from("<4sIQ", data, place)
        block = data[place:place + 16 + length]
        if word != b"fblk" or zlib.crc32(block[16:], zlib.crc32(block[8:16])) != checksum:
            return
        yield block
        place += 16 + length


def records(path):
    """Returns [(kind, contents)] of all records."""
    return [(block[16:17], block[17:]) for block in blocks(path)]


def name_of(record):
    """Returns the text at the beginning of a record."""
    length, = struct.unpack_from("<Q", record)
    return record[8:8 + length].decode()


def points_in(folder):
    """Returns {name: record} of the finished points of a sweep."""
    paths = sorted(folder.glob("*.points")) if folder.is_dir() else []
    return {name_of(record): record for path in paths
            for kind, record in records(path) if kind == b"p"}


def drop(path, *names):
    """Removes points from a journal."""
    path.write_bytes(b"".join(block for block in blocks(path)
                              if block[16:17] != b"p" or name_of(block[17:]) not in names))
