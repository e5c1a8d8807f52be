// Everything listens to the choice; the strongest instability is the first.

startShape();
startCharts();
startExplain();
startPressure();
startTable();
startChecks();
const first = data.instabilities[0];
if (first) choice.set(first.modes.includes(first.worst) || !first.modes.length ? first.worst : first.modes[first.modes.length - 1]);
