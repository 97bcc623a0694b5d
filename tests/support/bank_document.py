"""The modes of a bank, read from its .glb by Python alone: an oracle for what Ringdown's own reader says."""
import json
import struct


def read_bank(path):
    """The bank's model, a dictionary of KHR_audio_rigid_bodies, and a function that returns an accessor's numbers.

    Accessors are floats, of which a vector's follow one another, and are not compressed.
    """
    with open(path, "rb") as file:
        data = file.read()
    size = struct.unpack_from("<I", data, 12)[0]
    document, binary = json.loads(data[20 : 20 + size]), data[28 + size :]

    def numbers(index):
        accessor = document["accessors"][index]
        view = document["bufferViews"][accessor["bufferView"]]
        start = view.get("byteOffset", 0) + accessor.get("byteOffset", 0)
        count = accessor["count"] * {"SCALAR": 1, "VEC3": 3}[accessor["type"]]
        return struct.unpack_from(f"<{count}f", binary, start)

    return document["extensions"]["KHR_audio_rigid_bodies"]["modalModels"][0], numbers
