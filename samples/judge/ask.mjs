// Asks each engine for each map, and prints what it showed.
import { open_browser } from './browser.mjs';

const maps = process.argv.slice(2), browser = await open_browser();
for (const engine of ['three', 'babylon_own']) {
  const found = {};
  for (const map of maps) {
    const said = await browser.ask({ engine, probe: `asked/${map}` });
    if (said.error) console.error(`${engine}, ${map}: ${said.error}`);
    else found[map] = said;
  }
  if (Object.keys(found).length === maps.length) console.log(JSON.stringify({ engine, found }));
}
await browser.close();
