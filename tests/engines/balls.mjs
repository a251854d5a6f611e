// The balls of pictures.mjs as GLB files, and what Cycles needs to know of them.
import { mkdirSync, rmSync, writeFileSync } from 'node:fs';
import { ball_glb } from './ball.mjs';
import { balls, eye, fov, name_of, size } from './pictures.mjs';

rmSync('balls', { recursive: true, force: true });
mkdirSync('balls');
for (const ball of balls) writeFileSync(`balls/${name_of(ball)}.glb`, ball_glb(ball));
writeFileSync('balls/wanted.json', JSON.stringify({ size, fov, eye, balls: Object.fromEntries(balls.map((b) => [name_of(b), b])) }));
