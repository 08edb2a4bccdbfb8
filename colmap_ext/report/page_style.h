#pragma once

namespace colmap_ext {

// Of all pages: for dark and light, for narrow and wide windows.
inline constexpr const char* kPageStyle = R"(
:root { color-scheme: light dark; --page: #fbfbfa; --card: #ffffff;
  --line: #dcdcd8; --text: #20242a; --soft: #666d78; --panel: #f1f2f3;
  --curve: #1f5fa8; --warn: #fff3d6; --warn-line: #d9a400; }
@media (prefers-color-scheme: dark) {
  :root { --page: #16181c; --card: #1e2126; --line: #363b43; --text: #e4e6ea;
    --soft: #9aa2ae; --panel: #282c33; --curve: #7db3f0; --warn: #3a3011;
    --warn-line: #c79a1a; } }
* { box-sizing: border-box; }
body { margin: 0 auto; max-width: 84rem; padding: 1.5rem;
  background: var(--page); color: var(--text);
  font: 15px/1.45 system-ui, "Segoe UI", "DejaVu Sans", sans-serif; }
h1 { margin: 0; font-size: 1.6rem; }
h2 { margin: 2.2rem 0 0.7rem; font-size: 1.2rem; }
h3 { margin: 0 0 0.4rem; font-size: 1rem; }
p { margin: 0.2rem 0; }
.soft { color: var(--soft); overflow-wrap: anywhere; }
.keys { display: flex; flex-wrap: wrap; gap: 0.7rem; margin: 1.2rem 0 0;
  padding: 0; list-style: none; }
.keys li { flex: 1 1 9rem; padding: 0.6rem 0.9rem; background: var(--card);
  border: 1px solid var(--line); border-radius: 6px; }
.keys b { display: block; font-size: 1.25rem; font-weight: 600; }
.warnings { margin: 1.2rem 0 0; padding: 0.7rem 1rem 0.7rem 2rem;
  background: var(--warn); border: 1px solid var(--warn-line);
  border-radius: 6px; overflow-wrap: anywhere; }
.cards { columns: 2 34rem; column-gap: 1rem; }
.card { break-inside: avoid; margin: 0 0 1rem; padding: 0.8rem 1rem;
  background: var(--card); border: 1px solid var(--line); border-radius: 6px;
  overflow-x: auto; }
table { border-collapse: collapse; width: 100%; font-size: 0.85rem; }
th, td { padding: 0.12rem 0; text-align: left; vertical-align: top;
  font-weight: normal; }
th { min-width: 5rem; padding-right: 1rem; color: var(--soft);
  overflow-wrap: anywhere; }
td { overflow-wrap: anywhere; }
th.inner { padding-left: 1rem; }
td.numbers { white-space: pre;
  font-family: ui-monospace, "DejaVu Sans Mono", monospace; }
.stages td, .stages th + th { padding: 0.12rem 0 0.12rem 1rem; text-align: right;
  font-variant-numeric: tabular-nums; }
tr.names td { color: var(--soft); }
tr + tr { border-top: 1px solid var(--panel); }
.long { max-height: 30rem; overflow-y: auto; }
.plot svg { max-width: 100%; min-width: 44rem; height: auto; }
.plot svg > rect:first-child { fill: none; }
.plot rect { fill: var(--panel); }
.plot text { fill: var(--text); }
.plot polyline { stroke: var(--curve); }
.plot g { fill: var(--curve); }
.pictures { display: grid; gap: 0.7rem; margin: 0 0 1.4rem; }
.pictures figure { margin: 0; }
.pictures img { display: block; width: 100%; height: auto;
  border: 1px solid var(--line); border-radius: 4px; }
.pictures figcaption { color: var(--soft); font-size: 0.8rem;
  overflow-wrap: anywhere; }
.pictures .none { padding: 3rem 0; text-align: center; color: var(--soft);
  border: 1px dashed var(--line); border-radius: 4px; }
@media (max-width: 40rem) {
  .pictures { grid-template-columns: 1fr !important; } }
.scale { display: inline-block; width: 10rem; height: 0.7rem; margin: 0 0.4rem;
  background: linear-gradient(to right, #440154, #482878, #3e4a7a, #31688e,
    #26828e, #1f9e89, #35b779, #6dcd59, #b4de2c, #fde725); }
summary { cursor: pointer; margin: 0.5rem 0; }
code { font-family: ui-monospace, "DejaVu Sans Mono", monospace; }
)";

}  // namespace colmap_ext
