"""Clouds and meshes that are whole files, but hard: lattices, planes, few
points, doubled and torn faces."""

import struct

import numpy as np

from outputs import read_mesh


def _read_cloud(folder):
    """(header, [N, size] bytes of the rows, rows of views)."""
    data = (folder / "fused.ply").read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    words = data[:end].split()
    count = int(words[words.index(b"vertex") + 1])
    rows = np.frombuffer(data[end:], "u1").reshape(count, -1).copy()
    numbers = np.frombuffer((folder / "fused.ply.vis").read_bytes()[8:], "<u4")
    views, at = [], 0
    for _ in range(count):
        views.append(numbers[at + 1:at + 1 + numbers[at]].tolist())
        at += 1 + int(numbers[at])
    return data[:end], rows, views


def _write_cloud(folder, header, rows, views):
    lines = [b"element vertex %d" % len(rows)
             if line.startswith(b"element vertex") else line
             for line in header.split(b"\n")]
    (folder / "fused.ply").write_bytes(b"\n".join(lines) + rows.tobytes())
    (folder / "fused.ply.vis").write_bytes(
        struct.pack("<Q", len(views)) +
        b"".join(struct.pack(f"<{len(v) + 1}I", len(v), *v) for v in views))


def _edit_positions(rng, kind, positions):
    """[N, 3] float32"""
    size = float(np.ptp(positions, 0).max()) or 1.0
    axis = rng.randrange(3)
    chosen = np.array([rng.random() < 0.1 for _ in positions])
    if kind == "lattice":
        step = size / rng.choice([3, 10, 40, 150, 400])
        positions = np.round(positions / step) * step
    elif kind == "plane":
        positions[:, axis] = positions[0, axis]
    elif kind == "half plane":
        above = positions[:, axis] > np.median(positions[:, axis])
        positions[above, axis] = np.median(positions[:, axis])
    elif kind == "line":
        positions[:, [axis - 1, axis]] = positions[0, [axis - 1, axis]]
    elif kind == "one place":
        positions[:] = positions[0]
    elif kind == "few places":
        positions[:] = positions[np.arange(len(positions)) % rng.randrange(2, 9)]
    elif kind == "far away":
        positions[rng.randrange(len(positions))] *= 10.0 ** rng.randrange(2, 30)
    elif kind == "doubled":
        positions[chosen] = positions[0]
    return positions


CLOUDS = ["lattice", "lattice", "plane", "half plane", "line", "one place",
          "few places", "far away", "doubled", "few points", "few points",
          "one view each", "no views", "views doubled"]


def edit_cloud(rng, folder):
    """Makes the fused points of a workspace hard. Returns how, a text."""
    header, rows, views = _read_cloud(folder)
    kind = rng.choice(CLOUDS)
    if kind == "few points":
        chosen = sorted(rng.sample(range(len(rows)),
                                   min(len(rows), rng.choice([0, 1, 3, 4, 5, 8, 30]))))
        rows, views = rows[chosen], [views[i] for i in chosen]
    elif kind == "one view each":
        views = [row[:1] for row in views]
    elif kind == "no views":
        views = [row if rng.random() < 0.3 else [] for row in views]
    elif kind == "views doubled":
        views = [2 * row for row in views]
    else:
        positions = rows[:, :12].copy().view("<f4")
        rows[:, :12] = _edit_positions(
            rng, kind, positions).astype("<f4").view("u1").reshape(-1, 12)
    _write_cloud(folder, header, rows, views)
    return f"points: {kind}"


def _edit_faces(rng, kind, positions, faces):
    """Returns (positions, faces)."""
    some = np.array([rng.random() < rng.choice([0.01, 0.3]) for _ in faces])
    if kind == "torn":
        faces = faces[~some]
    elif kind == "turned":
        faces[some] = faces[some][:, ::-1]
    elif kind == "doubled":
        faces = np.concatenate([faces, faces[some]])
    elif kind == "joined":
        faces[some, 0] = faces[0, 0]
    elif kind == "crumpled":
        size = float(np.ptp(positions, 0).max())
        noise = np.random.default_rng(rng.randrange(1000)).normal(
            0, size * rng.choice([1e-3, 0.02, 0.5]), positions.shape)
        positions = positions + noise
    elif kind == "flat":
        positions[:, rng.randrange(3)] = 0
    elif kind == "shrunk":  # not much of it: what meets in one place is squared
        positions[faces[:10].ravel()] = positions[faces[0, 0]]
    elif kind == "split":
        positions, faces = positions[faces.ravel()], np.arange(
            faces.size).reshape(-1, 3)
    elif kind == "small":
        faces = faces[:rng.choice([0, 1, 2, 10])]
    elif kind == "moved":
        positions = positions + 10.0 ** rng.randrange(-1, 8)
    elif kind == "scaled":
        positions = positions * 10.0 ** rng.randrange(-12, 12)
    return positions, faces


MESHES = ["torn", "turned", "doubled", "joined", "crumpled", "flat", "shrunk",
          "split", "small", "moved", "scaled"]


def edit_mesh(rng, path):
    """Makes a mesh hard, and removes its .vis. Returns how, a text."""
    vertices, faces = read_mesh(path)
    positions = np.stack([vertices[name] for name in "xyz"], 1).astype(float)
    kind = rng.choice(MESHES)
    positions, faces = _edit_faces(rng, kind, positions, faces.copy())
    rows = np.zeros(len(faces), [("count", "u1"), ("corners", "<i4", (3,))])
    rows["count"], rows["corners"] = 3, faces
    path.write_bytes(
        b"ply\nformat binary_little_endian 1.0\nelement vertex %d\n"
        b"property float x\nproperty float y\nproperty float z\n"
        b"element face %d\nproperty list uchar int vertex_index\nend_header\n"
        % (len(positions), len(faces))
        + positions.astype("<f4").tobytes() + rows.tobytes())
    path.with_name(path.name + ".vis").unlink(missing_ok=True)
    return f"{path.name}: {kind}"
