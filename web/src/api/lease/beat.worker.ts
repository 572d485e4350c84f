// A page in the background has its timers slowed down to one a minute; a worker's go on, and end with the page.
setInterval(() => self.postMessage(null), 5000);
