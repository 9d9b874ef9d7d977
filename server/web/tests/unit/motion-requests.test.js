// Windows, nodes and ranges of the requests for a node's motion.

import assert from "node:assert/strict";
import { test } from "node:test";
import * as requests from "../../data/motion-requests.js";

const query = (text = "") => new URLSearchParams(text);

/** A point of 60 s. */
function point(orbit_window, summary = {}) {
  return {
    scenario: {
      duration: 60,
      recording: { orbit_window, rate_hz: 1000, nodes: [{ node: 10 }, { depth: 57.7 }] },
    },
    summary,
  };
}

const SETTLED = point("settled", { statistics_from: 100, statistics_to: 300 });

test("the window of the statistics is the run's last third, its own, or at most 80 s of a settled run", () => {
  assert.deepEqual(requests.verifiedWindow(point(null)), { from: 40, to: 60 });
  assert.deepEqual(requests.verifiedWindow(point({ from: 15, to: 25 })), { from: 15, to: 25 });
  assert.deepEqual(requests.verifiedWindow(SETTLED), { from: 220, to: 300 });
});

test("histories are kept of the whole run, or of the window of a settled one", () => {
  assert.deepEqual(requests.keptWindow(point({ from: 15, to: 25 })), { from: 0, to: 60 });
  assert.deepEqual(requests.keptWindow(SETTLED), { from: 220, to: 300 });
});

test("a window of the link is taken if it is one, up to the end of the run", () => {
  assert.deepEqual(requests.chosenWindow(point(null), query("from=10&to=20")), { from: 10, to: 20 });
  assert.deepEqual(requests.chosenWindow(point(null), query("from=10&to=900")), { from: 10, to: 60 });
  for (const text of ["", "from=20&to=10", "from=-1&to=10", "from=x&to=y"]) {
    assert.deepEqual(requests.chosenWindow(point(null), query(text)), { from: 40, to: 60 });
  }
});

test("a node is requested by number or by depth; the first unless the link names another", () => {
  const { scenario } = point(null);
  assert.deepEqual(requests.selectedNode(scenario, query()), { node: 10 });
  assert.deepEqual(requests.selectedNode(scenario, query("node=57.7m")), {
    depth: 57.7,
    nearest: true,
  });
  assert.deepEqual(requests.selectedNode(scenario, query("node=7")), { node: 10 });
});

test("a node of a link that was not recorded is named", () => {
  const { scenario } = point(null);
  assert.deepEqual(scenario.recording.nodes.map(requests.nodeInLink), ["10", "57.7m"]);
  for (const [text, unrecorded] of [
    ["", ""],
    ["node=10", ""],
    ["node=57.7m", ""],
    ["node=1", "1"],
    ["node=12m", "12m"],
  ])
    assert.equal(requests.unrecordedNode(scenario, query(text)), unrecorded);
});

test("a spectrum goes no farther than half the rate of its samples", () => {
  assert.deepEqual(requests.rangesOf(1000), ["5", "20", "50", "100"]);
  assert.deepEqual(requests.rangesOf(40), ["5", "20"]);
  assert.equal(requests.spectrumRange(query(), 1000), 20);
  assert.equal(requests.spectrumRange(query("range=100"), 1000), 100);
  assert.equal(requests.spectrumRange(query("range=100"), 20), 5);
  assert.equal(requests.spectrumRange(query(), 6), 3);
});
