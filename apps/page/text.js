"use strict";
// Numbers and tables; every text goes in as text, whatever it holds.

function byId(id) {
  return document.getElementById(id);
}

function formatNumber(value, digits) {
  if (value === null || value === undefined) return "–";
  const text = Number.isInteger(value) && digits === undefined ? value.toLocaleString("en-US")
    : Number(value).toLocaleString("en-US", { maximumSignificantDigits: digits ?? 4 });
  return text.replace("-", "−");
}

function formatFixed(value, decimals) {
  if (value === null || value === undefined) return "–";
  const size = Math.abs(value).toLocaleString("en-US",
    { minimumFractionDigits: decimals, maximumFractionDigits: decimals });
  return (value < 0 && /[1-9]/.test(size) ? "−" : "") + size;
}

// Columns: { title, text: row -> string, align: "text" or nothing }.
function drawTable(element, columns, rows) {
  const table = document.createElement("table");
  const head = table.createTHead().insertRow();
  for (const column of columns) {
    const cell = document.createElement("th");
    cell.textContent = column.title;
    if (column.align) cell.className = column.align;
    head.appendChild(cell);
  }
  const body = table.createTBody();
  for (const row of rows) {
    const line = body.insertRow();
    for (const column of columns) {
      const cell = line.insertCell();
      cell.textContent = column.text(row);
      if (column.align) cell.className = column.align;
    }
  }
  element.replaceChildren(table);
}
