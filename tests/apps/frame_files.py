"""Writers of frames in the formats of cameras, and frames of an object behind a thin diffuser by Fourier optics."""

import struct
import zlib

import h5py
import numpy as np


def write_png(path, values):
    """Writes a PNG file of 8 or 16 bit, as the type of the values states: grey, or with a last axis of 3 or 4 channels."""
    rows, columns, *channels = values.shape
    colour = {(): 0, (3,): 2, (4,): 6}[tuple(channels)]
    data = values.astype(values.dtype.newbyteorder(">"))
    raw = b"".join(b"\0" + row.tobytes() for row in data)

    def chunk(kind, content):
        return struct.pack(">I", len(content)) + kind + content + struct.pack(">I", zlib.crc32(kind + content))

    header = struct.pack(">IIBBBBB", columns, rows, 8 * values.dtype.itemsize, colour, 0, 0, 0)
    path.write_bytes(b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(raw)) + chunk(b"IEND", b""))


def write_tiff(path, pages):
    """Writes a grey TIFF file without compression; one page for each picture."""
    out = bytearray(b"II*\0" + struct.pack("<I", 0))
    link = 4  # place of the offset of the next directory
    for values in pages:
        place = len(out)
        out += values.astype(values.dtype.newbyteorder("<")).tobytes()
        rows, columns = values.shape
        kind = {"u": 1, "i": 2, "f": 3}[values.dtype.kind]
        entries = [(256, 4, columns), (257, 4, rows), (258, 3, 8 * values.dtype.itemsize), (259, 3, 1), (262, 3, 1),
                   (273, 4, place), (277, 3, 1), (278, 4, rows), (279, 4, values.nbytes), (339, 3, kind)]
        out[link:link + 4] = struct.pack("<I", len(out))
        out += struct.pack("<H", len(entries))
        for tag, size, value in entries:
            out += struct.pack("<HHII", tag, size, 1, value)
        link = len(out)
        out += struct.pack("<I", 0)
    path.write_bytes(out)


def write_all(folder, values):
    """Writes one frame of 16-bit numbers in six formats. Returns {name of the file: keys that it needs}."""
    write_png(folder / "frame.png", values)
    write_tiff(folder / "frame.tif", [values])
    np.save(folder / "frame.npy", values)
    with h5py.File(folder / "frame.h5", "w") as file:
        file["camera/frame"] = values
        file["camera/gain"] = 2.0
    np.savetxt(folder / "frame.csv", values, fmt="%d", delimiter=",")
    write_tiff(folder / "float.tif", [values.astype(np.float32)])
    return {"frame.png": {}, "frame.tif": {}, "frame.npy": {}, "frame.h5": {}, "frame.csv": {"frame_axes": "picture"},
            "float.tif": {}}


def letter(side=24):
    """A letter E on a dark ground."""
    picture = np.zeros((side, side))
    picture[3:21, 4:8] = 1
    for top in (3, 10, 17):
        picture[top:top + 3, 4:18] = 1
    return picture


def speckle(pixels, grain, random):
    """Far field behind a round pupil with random phases: intensity with grains of about `grain` pixels."""
    y, x = np.mgrid[:pixels, :pixels] - pixels // 2
    pupil = np.hypot(x, y) < pixels / grain / 2
    field = np.fft.fft2(np.fft.ifftshift(pupil * np.exp(2j * np.pi * random.random((pixels, pixels)))))
    return np.abs(field)**2


def diffused(pixels, picture, grain, random, photons=None):
    """A frame of an incoherent object behind a thin diffuser: speckle convolved with the object, under an envelope, with
    shot noise."""
    whole = np.zeros((pixels, pixels))
    whole[:picture.shape[0], :picture.shape[1]] = picture
    light = np.real(np.fft.ifft2(np.fft.fft2(speckle(pixels, grain, random)) * np.fft.fft2(whole)))
    y, x = np.mgrid[:pixels, :pixels] - pixels / 2
    light *= np.exp(-(x * x + y * y) / (2 * (0.6 * pixels)**2))
    light /= light.mean()
    return light if photons is None else random.poisson(photons * light).astype(float)


def similarity(truth, found, turns=(False, True)):
    """Largest normalised sum of products of two pictures over shifts and, for True in turns, rotated by 180 degrees."""
    size = sum(truth.shape) + sum(found.shape)
    first = np.fft.rfft2(truth, (size, size))
    best = 0
    for turned in (found[::-1, ::-1] if turn else found for turn in turns):
        products = np.fft.irfft2(first * np.conj(np.fft.rfft2(turned, (size, size))))
        best = max(best, products.max())
    return best / np.sqrt((truth**2).sum() * (found**2).sum())
