// A click on a head sorts its table by that column, a second one the other way round.
for (const table of document.querySelectorAll('table.sort')) {
  table.querySelectorAll('th').forEach((head, column) => {
    head.onclick = () => {
      const up = head.dataset.up !== '1';
      head.dataset.up = up ? '1' : '0';
      const key = row => row.cells[column].dataset.v ?? row.cells[column].textContent;
      const compare = (a, b) => {
        const [x, y] = [parseFloat(a), parseFloat(b)];
        return isNaN(x) || isNaN(y) ? a.localeCompare(b) : x - y;
      };
      const body = table.tBodies[0];
      [...body.rows].sort((a, b) => (up ? 1 : -1) * compare(key(a), key(b))).forEach(row => body.append(row));
    };
  });
}
