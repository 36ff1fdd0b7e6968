// Present only while the page is being developed: loads it anew after a rebuild.
let known;
setInterval(async () => {
  const builds = await fetch("/dev/builds").then((answer) => answer.text(), () => known);
  if (known !== undefined && builds !== known) location.reload();
  known = builds;
}, 1000);
