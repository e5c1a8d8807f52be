// Starts all parts of the page, then chooses the first instability, which is the strongest.

startShapes();
startCharts();
startExplain();
startPressure();
startTable();
startChecks();
const first = data.instabilities[0];
if (first)
  choice.set(
    first.modes.includes(first.worst) || !first.modes.length ? first.worst : first.modes[first.modes.length - 1],
  );
