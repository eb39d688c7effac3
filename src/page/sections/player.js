import { el } from '../core/dom.js';
import { way } from '../core/kinematics.js';

const secondsPerMove = 1.1;

/**
 * Steps through poses: buttons, slider, play, arrow keys on `stage`. `show(k, joints)` draws pose k,
 * or on the way to it the joints given; `say(k)` is what is read out.
 */
export function player(poses, stage, show, say) {
  let current = 0;
  let playing = null;
  const status = el('output', { class: 'status', 'aria-live': 'polite' });
  const slider = el('input', { type: 'range', min: 1, max: poses.length, step: 1, value: 1, 'aria-label': 'Pose' });
  const play = el('button', { type: 'button', 'aria-pressed': 'false' }, 'Play');

  function go(k) {
    current = Math.min(poses.length - 1, Math.max(0, k));
    slider.value = String(current + 1);
    slider.setAttribute('aria-valuetext', say(current));
    status.textContent = say(current);
    show(current, null);
  }
  function stop() {
    if (playing === null) return;
    cancelAnimationFrame(playing);
    playing = null;
    play.textContent = 'Play';
    play.setAttribute('aria-pressed', 'false');
    status.setAttribute('aria-live', 'polite');
  }
  function start() {
    if (current === poses.length - 1) go(0);
    play.textContent = 'Pause';
    play.setAttribute('aria-pressed', 'true');
    status.setAttribute('aria-live', 'off');
    const still = matchMedia('(prefers-reduced-motion: reduce)').matches;
    let began = null;
    const tick = (now) => {
      began ??= now;
      const next = poses[current + 1];
      if (!next) return stop();
      const part = (now - began) / (1000 * secondsPerMove);
      if (part >= 1.25) {
        began = now;
        go(current + 1);
      } else if (!still && part < 1) {
        const list = way(poses[current].joints, next.joints, next.via, 30);
        const smooth = part * part * (3 - 2 * part);
        show(current, list[Math.round(smooth * (list.length - 1))]);
      } else if (!still) {
        show(current, next.joints);
      }
      playing = requestAnimationFrame(tick);
    };
    playing = requestAnimationFrame(tick);
  }
  const step = (k) => {
    stop();
    go(k);
  };
  play.addEventListener('click', () => (playing === null ? start() : stop()));
  slider.addEventListener('input', () => step(Number(slider.value) - 1));
  stage.addEventListener('keydown', (event) => {
    const to = { ArrowLeft: current - 1, ArrowRight: current + 1, Home: 0, End: poses.length - 1 }[event.key];
    if (to === undefined) return;
    event.preventDefault();
    step(to);
  });
  const bar = el(
    'div',
    { class: 'player' },
    el('button', { type: 'button', 'aria-label': 'Previous pose', onclick: () => step(current - 1) }, '\u2190'),
    play,
    el('button', { type: 'button', 'aria-label': 'Next pose', onclick: () => step(current + 1) }, '\u2192'),
    slider,
    status,
  );
  return { bar, go };
}
