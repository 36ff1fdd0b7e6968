//! The report's look, on screen and on A4 and Letter paper.

/// The style sheet. Sizes are relative or in points, so that both paper formats hold the same content; colors are
/// those of the light theme.
///
/// Firefox and Safari put nothing into the margins of pages. There the hash is at the foot of each page (`.foot`), and
/// the numbers (`.sheets`) lie a page's height from each other over the whole length of the report: those behind its end
/// have no height. The last page may have none: room that a page leaves free before a drawing does not count. It says that
/// the report ends there. They do not keep a heading with what follows, either: it asks for room for a few lines.
pub(crate) const STYLE: &str = "
:root { color: #161d26; background: #fff; font: 10.5pt/1.45 'Ubuntu', 'Inter', 'Segoe UI', 'Helvetica Neue', Arial, sans-serif; }
body { max-width: 62rem; margin: 2rem auto; padding: 0 1.5rem; }
h1 { font-size: 1.7em; margin: 0 0 .2em; line-height: 1.2; }
h2 { font-size: 1.2em; margin: 2em 0 .5em; padding-bottom: .2em; border-bottom: 1px solid #d9dfe6; }
h3 { font-size: 1em; margin: 1.4em 0 .3em; color: #4e5b6a; }
a { color: #0068a8; text-decoration: none; }
a:hover { text-decoration: underline; }
p, ul { margin: .4em 0; }
table { border-collapse: collapse; width: 100%; margin: .5em 0 1em; font-size: .92em; }
th { text-align: left; font-weight: 600; color: #4e5b6a; border-bottom: 1px solid #a9b5c2; }
th, td { padding: .25em .8em .25em 0; vertical-align: top; overflow-wrap: anywhere; }
td { border-bottom: 1px solid #eef1f4; min-width: 4.8em; }
td.figure { min-width: 0; }
td.figure, th.figure { text-align: right; font-variant-numeric: tabular-nums; }
th { overflow-wrap: normal; vertical-align: bottom; }
td.figure, td:last-child { white-space: nowrap; overflow-wrap: normal; }
thead { display: table-header-group; }
.in-print, .foot, .sheets, .end { display: none; }
del { background: #fbe4e1; text-decoration: none; }
ins { background: #dff3e4; text-decoration: none; }
.facts { display: grid; grid-template-columns: max-content 1fr; gap: .1em 1.2em; margin: 1em 0; }
.facts dt { color: #4e5b6a; }
.facts dd { margin: 0; overflow-wrap: anywhere; }
.hash, code { font-family: 'Ubuntu Mono', 'JetBrains Mono', Menlo, Consolas, monospace; font-size: .95em; }
.status { white-space: nowrap; font-weight: 600; }
.information { color: #4e5b6a; }
.passed { color: #007555; }
.attention { color: #9a6200; }
.failed { color: #b84300; }
.signatures td { height: 2.2em; border-bottom: 1px solid #a9b5c2; }
.signatures td:last-child { min-width: 14em; width: 40%; }
.criterion { min-width: 11em; }
.muted { color: #5a6674; }
figure { margin: .8em 0; }
figure svg { display: block; max-width: 100%; height: auto; }
figure.on-screen { overflow-x: auto; }
figure.on-screen svg { max-width: none; }
figcaption { color: #4e5b6a; font-size: .9em; margin-top: .4em; }
.listing { font-size: .86em; line-height: 1.45; white-space: pre-wrap; overflow-wrap: anywhere; margin: 0; }
.listing .line { display: block; padding-left: 3.6em; text-indent: -3.6em; }
.listing .line:target { background: #fff3d6; }
.listing b { display: inline-block; width: 2.8em; margin-right: .8em; text-align: right; text-indent: 0; font-weight: 400; color: #a3aeba; user-select: none; }
.listing i { font-style: normal; }
.listing .comment { color: #5a6674; font-style: italic; }
.listing .keyword { color: #0072b2; font-weight: 600; }
.listing .activity { color: #161d26; font-weight: 600; }
.listing .condition { color: #007555; }
.listing .parameter { color: #9a6200; }
.listing .place { color: #9c3f77; }
.listing .number, .listing .string { color: #0068a8; }
.listing .unknown { color: #b84300; text-decoration: underline wavy; }
@page { margin: 16mm 15mm 18mm; }
@media print {
  .criterion { min-width: 8em; }
  td { min-width: 4.2em; }
  th, td { padding-right: .5em; }
  :root { font-size: 9.5pt; -webkit-print-color-adjust: exact; print-color-adjust: exact; }
  body { max-width: none; margin: 0; padding: 0; }
  a { color: inherit; }
  .on-screen { display: none; }
  tr.in-print { display: table-row; }
  figure.in-print { display: block; }
  h2, h3 { break-after: avoid; break-inside: avoid; }
  h2::after, h3::after { content: ''; display: block; height: 7em; margin-bottom: -7em; }
  tr, figure, .signatures, .together { break-inside: avoid; }
  figure svg { max-height: 225mm; }
  h2.page { break-before: page; }
  @supports (-moz-appearance: none) or (font: -apple-system-body) or (not (interpolate-size: allow-keywords)) {
    body { position: relative; padding-bottom: 2em; box-decoration-break: clone; -webkit-box-decoration-break: clone; }
    .foot { display: block; position: fixed; bottom: 0; left: 0; margin: 0; font-size: 6.5pt; color: #4e5b6a; }
    .sheets, .end { display: block; }
    .end { text-align: right; font-size: 8pt; color: #4e5b6a; }
    .sheets i { position: absolute; right: 0; overflow: hidden; font: 8pt/1.2 inherit; font-style: normal; color: #4e5b6a;
      top: min(var(--sheet) * 100vh, 100%); margin-top: -2.6em;
      height: clamp(0px, 100% - (var(--sheet) - 1) * 100vh, 1.2em); }
  }
}
";
