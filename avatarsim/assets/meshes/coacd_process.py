"""Worker process of CoACD, the only module that imports it: `python -m avatarsim.assets.meshes.coacd_process IN.npz OUT.npz`.

A process of its own, because CoACD writes to the standard output, ignores Ctrl-C, and may crash on a bad mesh.
"""

import sys

import numpy as np


def main(source: str, target: str) -> int:
    """Decompose every mesh of the file `source` into the file `target`; CoACD's log goes to the standard output."""
    import coacd

    coacd.set_log_level("info")
    hulls = []
    with np.load(source, allow_pickle=False) as wanted:
        threshold, seed, most = float(wanted["threshold"]), int(wanted["seed"]), int(wanted["most"])
        mode, resolution = ("on" if wanted["remesh"] else "off"), int(wanted["resolution"])
        for k in range(int(wanted["meshes"])):
            print(f"mesh {k}", flush=True)
            mesh = coacd.Mesh(wanted[f"vertices{k}"], wanted[f"triangles{k}"].astype(np.int32))
            hulls += coacd.run_coacd(
                mesh, threshold=threshold, seed=seed, max_convex_hull=most, preprocess_mode=mode,
                preprocess_resolution=resolution,
            )
    np.savez(target, **{f"hull{k}": vertices for k, (vertices, _) in enumerate(hulls)})
    return 0


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:3]))
