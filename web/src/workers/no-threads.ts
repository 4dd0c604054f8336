// Stands for the module with threads where that has not been built: see vite.config.ts.

export const start = () => Promise.reject(new Error("this page was built without threads"));
