"""What the scripts have in common that render a scene in Mitsuba 3: its objects, exactly as the geometry file has them,
and clouds."""

import json

import mitsuba as mi
import numpy as np


def rgb(value):
    return {"type": "rgb", "value": [float(x) for x in value]}


def cloud(densities, low, high, scattering, absorption, g):
    """A box of voxels with its edges along the axes, from one outer face to the other; densities count z, y, x."""
    transform = mi.ScalarTransform4f
    # Mitsuba's grids fill the cube from 0 to 1, and its cubes are from -1 to 1.
    box = transform().translate(list(low)) @ transform().scale(list(high - low))
    medium = {
        "type": "heterogeneous",
        "albedo": {"type": "constvolume", "value": scattering / (scattering + absorption)},
        "sigma_t": {"type": "gridvolume", "grid": mi.VolumeGrid(densities[..., None]), "to_world": box},
        "scale": float(scattering + absorption),
        "phase": {"type": "hg", "g": g},
    }
    cube = box @ transform().translate([0.5] * 3) @ transform().scale(0.5)
    return {"type": "cube", "to_world": cube, "bsdf": {"type": "null"}, "interior": medium}


def made_of(material):
    """What a material of a .glb file is as properties of a mesh: it reflects diffusely, and may shine."""
    colour = material["pbrMetallicRoughness"]["baseColorFactor"][:3]
    properties = {"bsdf": mi.load_dict({"type": "diffuse", "reflectance": rgb(colour)})}
    if "emissiveFactor" in material:
        extension = material.get("extensions", {}).get("KHR_materials_emissive_strength", {})
        radiance = np.array(material["emissiveFactor"]) * extension.get("emissiveStrength", 1.0)
        properties["emitter"] = mi.load_dict({"type": "area", "radiance": rgb(radiance)})
    return properties


def objects(path):
    """The objects of a .glb file by name: corners, triangles, none of them rounded, and what they are made of."""
    file = path.read_bytes()
    end = 20 + int.from_bytes(file[12:16], "little")
    gltf, binary = json.loads(file[20:end]), file[end + 8:]

    def triples(index, numbers_each):
        accessor = gltf["accessors"][index]
        kind = {5123: np.uint16, 5125: np.uint32, 5126: np.float32}[accessor["componentType"]]
        start = gltf["bufferViews"][accessor["bufferView"]]["byteOffset"] + accessor.get("byteOffset", 0)
        return np.frombuffer(binary, kind, numbers_each * accessor["count"], start).reshape(-1, 3)

    for node in gltf["nodes"]:
        if "mesh" not in node:
            continue
        [primitive] = gltf["meshes"][node["mesh"]]["primitives"]
        corners = triples(primitive["attributes"]["POSITION"], 3)
        triangles = triples(primitive["indices"], 1).astype(np.uint32)
        yield node["name"], corners, triangles, made_of(gltf["materials"][primitive["material"]])


def mesh(name, corners, triangles, **properties):
    """Triangles that meet in edges, with what they are made of."""
    given = mi.Properties()
    for key, value in properties.items():
        given[key] = value
    made = mi.Mesh(name, len(corners), len(triangles), given)
    values = mi.traverse(made)
    values["vertex_positions"], values["faces"] = np.float32(corners).ravel(), triangles.ravel()
    values.update()
    return made
