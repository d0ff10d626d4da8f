"use strict";
// The exposed areas of the residues, a plot for each chain.

const kPlot = { left: 46, right: 8, top: 8, bottom: 20, height: 130, least: 3 };  // px; `least` is of a bar

function svg(name, attributes, parent) {
  const element = document.createElementNS("http://www.w3.org/2000/svg", name);
  for (const [key, value] of Object.entries(attributes)) element.setAttribute(key, value);
  if (parent) parent.append(element);
  return element;
}

// 1, 2 or 5 times a power of ten: at most `count` of them make `most`.
function tickStep(most, count) {
  const power = 10 ** Math.floor(Math.log10(most / count));
  return [1, 2, 5, 10].map((m) => m * power).find((step) => most / step <= count);
}

class ResiduePlot {
  constructor(element, structure, residues, most, choose) {
    Object.assign(this, { structure, residues, most, choose });
    this.width = Math.max(kPlot.least, (element.clientWidth - kPlot.left - kPlot.right) / residues.length);
    this.width = Math.min(this.width, 14);
    const inner = this.width * residues.length, total = inner + kPlot.left + kPlot.right;
    this.root = svg("svg", { width: total, height: kPlot.height, tabindex: 0, role: "img" });
    this.drawAxes(inner);
    this.drawBars();
    this.mark = svg("rect", { class: "chosen", width: 0, height: 0 }, this.root);
    element.append(this.root);
    this.listen();
  }

  y(area) {
    return kPlot.height - kPlot.bottom - area / this.most * (kPlot.height - kPlot.top - kPlot.bottom);
  }

  drawAxes(inner) {
    const step = tickStep(this.most, 4);
    for (let area = 0; area <= this.most; area += step) {
      svg("line", { class: "grid", x1: kPlot.left, x2: kPlot.left + inner, y1: this.y(area), y2: this.y(area) }, this.root);
      svg("text", { x: kPlot.left - 6, y: this.y(area) + 4, "text-anchor": "end" }, this.root).textContent = formatNumber(area);
    }
    const every = tickStep(this.residues.length, Math.max(1, Math.floor(inner / 44)));
    for (let i = 0; i < this.residues.length; i += Math.max(1, every)) {
      const x = kPlot.left + (i + 0.5) * this.width;
      svg("text", { x, y: kPlot.height - 5, "text-anchor": "middle" }, this.root).textContent =
        this.structure.residues.number[this.residues[i]];
    }
  }

  drawBars() {
    const gap = this.width > 3.5 ? 1 : 0.4;
    const bars = this.residues.map((residue, i) => {
      const x = kPlot.left + i * this.width, y = this.y(this.structure.residues.area[residue]);
      return `M${x.toFixed(2)} ${this.y(0)}V${y.toFixed(2)}h${(this.width - gap).toFixed(2)}V${this.y(0)}Z`;
    });
    svg("path", { class: "bars", d: bars.join("") }, this.root);
  }

  listen() {
    const at = (event) => {
      const i = Math.floor((event.clientX - this.root.getBoundingClientRect().left - kPlot.left) / this.width);
      return i >= 0 && i < this.residues.length ? i : -1;
    };
    this.root.addEventListener("click", (event) => at(event) >= 0 && this.choose(this.residues[at(event)], true));
    this.root.addEventListener("mousemove", (event) => {
      const residue = this.residues[at(event)];
      showTip(residue === undefined ? "" : this.textOf(residue), event);
    });
    this.root.addEventListener("mouseleave", () => showTip(""));
    this.root.addEventListener("keydown", (event) => {
      const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
      if (!step && event.key !== "Enter") return;
      const now = Math.max(this.current ?? -1, -1);
      const next = step ? Math.min(Math.max(now + step, 0), this.residues.length - 1) : Math.max(now, 0);
      this.choose(this.residues[next], event.key === "Enter");
      event.preventDefault();
    });
  }

  textOf(residue) {
    return `${residueText(this.structure, residue)}: ${formatFixed(this.structure.residues.area[residue], 2)} Å² exposed`;
  }

  // Marks the residue if it is one of this plot's.
  show(residue) {
    this.current = this.residues.indexOf(residue);
    const has = this.current >= 0, x = kPlot.left + this.current * this.width;
    const top = has ? Math.min(this.y(this.structure.residues.area[residue]), this.y(0) - 3) : 0;
    const attributes = has ? { x: x - 1, y: top, width: this.width + 1, height: this.y(0) - top } : { width: 0, height: 0 };
    for (const [key, value] of Object.entries(attributes)) this.mark.setAttribute(key, value);
    const scroller = this.root.parentElement;
    if (has && (x < scroller.scrollLeft + kPlot.left || x > scroller.scrollLeft + scroller.clientWidth - 20)) {
      scroller.scrollLeft = x - scroller.clientWidth / 2;
    }
  }
}

// A plot for each chain; returns them.
function drawPlots(s, choose) {
  const byChain = s.chains.map(() => []);
  s.residues.chain.forEach((chain, residue) => byChain[chain].push(residue));
  byId("plot-section").hidden = s.residues.name.length < 2;
  byId("plots").replaceChildren();
  if (byId("plot-section").hidden) return [];
  const most = Math.max(1, s.residues.area.reduce((a, b) => Math.max(a, b), 0));
  return byChain.map((residues, chain) => {
    const holder = document.createElement("div"), title = document.createElement("h3"), wide = document.createElement("div");
    holder.className = "plot";
    wide.className = "wide";
    const area = residues.reduce((sum, r) => sum + s.residues.area[r], 0);
    const name = s.chains.length === 1 && !chainText(s.chains[chain]) ? "All" : `Chain ${s.chains[chain]}`;
    title.textContent = `${name}: ${countText(residues.length, "residue")}, ${formatFixed(area, 1)} Å²`;
    holder.append(title, wide);
    byId("plots").append(holder);
    const plot = new ResiduePlot(wide, s, residues, most, choose);
    plot.root.setAttribute("aria-label", `Exposed areas, ${name}. Left and right choose a residue, Enter goes there.`);
    return plot;
  });
}
