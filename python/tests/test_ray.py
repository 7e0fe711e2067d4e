"""The adapter of Ray: nodes of a cluster on one machine are killed while they draw. Runs where Ray is installed; `RAY_KILLS` says how often."""

from __future__ import annotations

import os
from pathlib import Path

import pytest
from test_batch import FILM, files, scene_file

import belvedere
from belvedere import batch

ray = pytest.importorskip("ray", reason="SKIPPED: the adapter of Ray is not tried; ray is not installed")

KILLS = int(os.environ.get("RAY_KILLS", "1"))


def test_a_killed_node_costs_time_alone(tmp_path: Path) -> None:
    from ray.cluster_utils import Cluster

    belvedere.animate(scene_file(tmp_path), tmp_path / "whole", **FILM)
    whole = files(tmp_path / "whole")
    cluster = Cluster(initialize_head=True, head_node_args={"num_cpus": 0, "include_dashboard": False})
    try:
        ray.init(address=cluster.address, log_to_driver=False)
        for run in range(KILLS):
            nodes = [cluster.add_node(num_cpus=1) for _ in range(2)]
            cluster.wait_for_nodes()
            state = {"killed": 0}

            def kill(work: str, share: float, nodes: list = nodes, state: dict = state) -> None:
                if share > 0 and not state["killed"]:
                    state["killed"] = 1
                    cluster.remove_node(nodes[0], allow_graceful=False)

            out = tmp_path / f"film{run}"
            _, report = batch.film(scene_file(tmp_path), out, on=batch.Ray(), frames_per_task=1, progress=kill, **FILM)
            assert state["killed"] == 1
            assert files(out) == whole, f"run {run}"
            assert report.adapter == "ray"
            cluster.remove_node(nodes[1], allow_graceful=False)
    finally:
        ray.shutdown()
        cluster.shutdown()
