// Finds the sections in which every word of the search stands; headings count most. `sections`, from sections.js, has
// [address, heading, text] of each.
"use strict";
function findSections(all, query) {
  const words = query.toLowerCase().split(/\s+/).filter(word => word.length > 1);
  if (!words.length) return [];
  const score = ([, heading, text]) => {
    const [high, low] = [heading.toLowerCase(), text.toLowerCase()];
    let sum = 0;
    for (const word of words) {
      const inText = low.split(word).length - 1, inHeading = high.includes(word) ? 10 : 0;
      if (!inText && !inHeading) return 0;
      sum += Math.min(inText, 5) + inHeading;
    }
    return sum;
  };
  const scored = all.map(section => [score(section), section]).filter(([sum]) => sum > 0);
  return scored.sort((a, b) => b[0] - a[0]).slice(0, 20).map(([, [address, heading, text]]) => {
    const at = Math.max(0, text.toLowerCase().indexOf(words[0]) - 60);
    return { address, heading, excerpt: text.slice(at, at + 180) };
  });
}
if (typeof document !== "undefined") {
  const found = document.getElementById("found"), field = document.getElementById("search");
  field.addEventListener("input", () => {
    found.replaceChildren(...findSections(sections, field.value).map(({ address, heading, excerpt }) => {
      const link = document.createElement("a"), words = document.createElement("small");
      link.href = found.dataset.up + "/" + address;
      link.textContent = heading;
      words.textContent = excerpt;
      link.append(words);
      return link;
    }));
  });
}
