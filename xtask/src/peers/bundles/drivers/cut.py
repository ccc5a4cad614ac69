"""Extraction of motion bundles in plain Python, and their graph by networkx: cut.py PEER RUNS JOB FOLDER.

`python extract` follows sections 3.3 and 3.4 of Beaudoin, van de Panne and Poulin 2007 as ours does, from the
first occurrence of each seed letter, with directly similar substrings only; `python extract-transitive` with
the transitive closure. Prints what the bundles, or the graph, come to, and the median of the process's CPU
milliseconds.
"""

import statistics
import struct
import sys
import time
from itertools import pairwise
from pathlib import Path


class Text:
    def __init__(self, folder):
        head, *lines = (folder / "string.txt").read_text().splitlines()
        tau, longest, gamma = head.split()
        self.longest, self.gamma = int(longest), float(gamma)
        runs = [tuple(map(int, line.split())) for line in lines]
        self.clips = [clip for clip, *_ in runs]
        # Twice the mean frame.
        self.middles = [start + end - 1 for _, start, end, _ in runs]
        self.letters = [label for *_, label in runs]
        numbers = (folder / "distances.f64").read_bytes()
        numbers = struct.unpack(f"<{len(numbers) // 8}d", numbers)
        self.kappa = round(len(numbers) ** 0.5)
        rows = range(0, len(numbers), self.kappa)
        self.distances = [numbers[row : row + self.kappa] for row in rows]
        self.near = [[d <= float(tau) for d in row] for row in self.distances]
        positions = list(enumerate(self.letters))
        self.starts = [[j for j, b in positions if row[b]] for row in self.near]

    def width(self, substring):
        return self.middles[substring[1]] - self.middles[substring[0]]

    def is_like(self, a, b):
        return self.gamma * max(a, b) <= min(a, b)


def similar(text, free, first, lasts, reference=None):
    """For each of `lasts` the substrings like the one from `first`, with mean distance and stretch.

    Their widths are like `reference`, or like that of the substring.
    """
    found = {last: [] for last in lasts}
    for start in text.starts[text.letters[first]]:
        end = start
        while end < start + text.longest - 1 and free[end]:
            end += 1
        if end == start:
            continue
        before = {}
        for i in range(first, lasts[-1] + 1):
            distances, near = text.distances[text.letters[i]], text.near[text.letters[i]]
            row = {}
            for k in range(start, end + 1):
                letter = text.letters[k]
                if not near[letter]:
                    continue
                entries = [before.get(k), before.get(k - 1), row.get(k - 1)]
                entries = [entry for entry in entries if entry is not None]
                if i == first and k == start:
                    entries = [(0.0, 0)]
                if entries:
                    total, cells = min(entries)
                    row[k] = (total + distances[letter], cells + 1)
            if not row:
                break
            if i in found:
                width = text.width((first, i))
                for k, (total, cells) in row.items():
                    other = (start, k)
                    apart = k <= first or i <= start
                    like = width if reference is None else reference
                    if k > start and apart and text.is_like(text.width(other), like):
                        stretch = abs(text.width(other) - width)
                        found[i].append((total / cells, stretch, other))
            before = row
    return found


def accept(members, candidates):
    for *_, other in sorted(candidates):
        if all(other[1] <= a or b <= other[0] for a, b in members):
            members.append(other)


def close(text, free, members):
    """What is like a member, and so on."""
    width = text.width(members[0])
    done = 1
    while done < len(members):
        free = free[:]
        for first, last in members:
            free[first:last] = [False] * (last - first)
        first, last = members[done]
        accept(members, similar(text, free, first, [last], width)[last])
        done += 1


def best_through(text, free, c, is_transitive):
    firsts = [c]
    while firsts[-1] > 0 and free[firsts[-1] - 1] and c - firsts[-1] < text.longest - 1:
        firsts.append(firsts[-1] - 1)
    best = None
    for first in firsts:
        lasts = []
        last = first + 1
        while last < first + text.longest and last < len(text.letters) and free[last - 1]:
            if last >= c:
                lasts.append(last)
            last += 1
        if not lasts:
            continue
        for last, candidates in similar(text, free, first, lasts).items():
            seed = (first, last)
            members = [seed]
            accept(members, candidates)
            if is_transitive:
                close(text, free, members)
            mean = sum(map(text.width, members)) / len(members)
            members = [m for m in members if m == seed or text.is_like(text.width(m), mean)]
            if len(members) > 1:
                mean = sum(map(text.width, members)) / len(members)
                volume = (len(members) - 1) * (mean / 2)
                rank = (volume, len(members), -first, -last)
                if best is None or rank > best[0]:
                    best = (rank, sorted(members))
    return best and best[1]


def extract(text, is_transitive):
    n = len(text.letters)
    free = [a == b for a, b in pairwise(text.clips)] + [False]
    bundles, single = [], []
    while True:
        open_ = [j for j in range(n) if free[j] or (j > 0 and free[j - 1])]
        if not open_:
            break
        counts = [0] * text.kappa
        for j in open_:
            counts[text.letters[j]] += 1
        letter = counts.index(max(counts))
        c = next(j for j in open_ if text.letters[j] == letter)
        members = best_through(text, free, c, is_transitive)
        if members:
            bundles.append(members)
        else:
            sides = [j for j in (c - 1, c) if j >= 0 and free[j]]
            side = min(sides, key=lambda j: (text.width((j, j + 1)), j))
            members = [(side, side + 1)]
            single += members
        for first, last in members:
            free[first:last] = [False] * (last - first)
    single.sort()
    n_degenerate = len(single) - sum(a[1] == b[0] for a, b in pairwise(single))
    return bundles, n_degenerate


def extract_facts(found):
    bundles, n_degenerate = found
    places = sum(
        number * sum(first + 2 * last for first, last in members)
        for number, members in enumerate(bundles, 1)
    )
    n_members = sum(map(len, bundles))
    return dict(bundles=len(bundles), members=n_members, degenerate=n_degenerate, places=places)


def read_spans(folder):
    lines = map(str.split, (folder / "spans.txt").read_text().splitlines())
    spans = [(id_, int(clip), int(start), int(end)) for id_, clip, start, end in lines]
    return [(clip, start, end, None if id_ == "-" else int(id_)) for id_, clip, start, end in spans]


def graph(spans):
    import networkx

    graph = networkx.MultiDiGraph()
    graph.add_nodes_from({bundle for *_, bundle in spans if bundle is not None})
    n_loose = 0
    # A submotion that begins where the one before ends is entered from there.
    before, between = None, None
    for clip, start, end, bundle in sorted(spans):
        span = (clip, start, end)
        last = between or (before and before[0])
        if last is None or last[0] != clip or last[2] != start:
            n_loose += between is not None
            before, between = None, None
        if bundle is None:
            if before is None or between is not None:
                n_loose += 1
                before = None
            else:
                between = span
            continue
        if before is not None:
            graph.add_edge(before[1], bundle, transition=between)
        before, between = (span, bundle), None
    n_loose += between is not None
    components = list(networkx.strongly_connected_components(graph))
    return graph, components, n_loose


def graph_facts(found):
    graph, components, n_loose = found
    edges = len(set(graph.edges()))
    passages = graph.number_of_edges()
    nodes = graph.number_of_nodes()
    return dict(
        nodes=nodes, edges=edges, passages=passages, loose=n_loose, components=len(components)
    )


def main(runs, work, given, facts):
    found = work(given)
    stated = " ".join(f"{key}={value}" for key, value in facts(found).items())
    times = []
    for _ in range(runs):
        begin = time.process_time()
        work(given)
        times.append((time.process_time() - begin) * 1e3)
    print(f"{stated} ms={statistics.median(times)}")


_, peer, runs, job, folder = sys.argv
folder = Path(folder)
match peer, job:
    case "python", "extract":
        main(int(runs), lambda text: extract(text, False), Text(folder), extract_facts)
    case "python", "extract-transitive":
        main(int(runs), lambda text: extract(text, True), Text(folder), extract_facts)
    case "networkx", "graph":
        main(int(runs), graph, read_spans(folder), graph_facts)
    case _:
        sys.exit(f"no job {job} for {peer}")
