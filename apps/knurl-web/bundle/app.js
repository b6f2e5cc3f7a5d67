"use strict";(()=>{var r_="uplot",o_="u-hz",a_="u-vt",l_="u-title",c_="u-wrap",h_="u-under",u_="u-over",f_="u-axis",yr="u-off",d_="u-select",p_="u-cursor-x",m_="u-cursor-y",g_="u-cursor-pt",y_="u-legend",__="u-live",x_="u-inline",v_="u-series",b_="u-marker",hp="u-label",M_="u-value",aa="width",la="height";var up="bottom",eo="left",fu="right",Ru="#000",fp=Ru+"0",du="mousemove",dp="mousedown",pu="mouseup",pp="mouseenter",mp="mouseleave",gp="dblclick",S_="resize",w_="scroll",yp="change",yl="dppxchange",Iu="--",ao=typeof window<"u",xu=ao?document:null,no=ao?window:null,A_=ao?navigator:null,Rt,dl;function vu(){let i=devicePixelRatio;Rt!=i&&(Rt=i,dl&&Mu(yp,dl,vu),dl=matchMedia(`(min-resolution: ${Rt-.001}dppx) and (max-resolution: ${Rt+.001}dppx)`),_r(yp,dl,vu),no.dispatchEvent(new CustomEvent(yl)))}function vi(i,e){if(e!=null){let t=i.classList;!t.contains(e)&&t.add(e)}}function bu(i,e){let t=i.classList;t.contains(e)&&t.remove(e)}function Jt(i,e,t){i.style[e]=t+"px"}function Hi(i,e,t,n){let s=xu.createElement(i);return e!=null&&vi(s,e),t?.insertBefore(s,n),s}function Ni(i,e){return Hi("div",i,e)}var _p=new WeakMap;function ls(i,e,t,n,s){let r="translate("+e+"px,"+t+"px)",o=_p.get(i);r!=o&&(i.style.transform=r,_p.set(i,r),e<0||t<0||e>n||t>s?vi(i,yr):bu(i,yr))}var xp=new WeakMap;function vp(i,e,t){let n=e+t,s=xp.get(i);n!=s&&(xp.set(i,n),i.style.background=e,i.style.borderColor=t)}var bp=new WeakMap;function Mp(i,e,t,n){let s=e+""+t,r=bp.get(i);s!=r&&(bp.set(i,s),i.style.height=t+"px",i.style.width=e+"px",i.style.marginLeft=n?-e/2+"px":0,i.style.marginTop=n?-t/2+"px":0)}var Pu={passive:!0},E_={...Pu,capture:!0};function _r(i,e,t,n){e.addEventListener(i,t,n?E_:Pu)}function Mu(i,e,t,n){e.removeEventListener(i,t,Pu)}ao&&vu();function Gi(i,e,t,n){let s;t=t||0,n=n||e.length-1;let r=n<=2147483647;for(;n-t>1;)s=r?t+n>>1:bi((t+n)/2),e[s]<i?t=s:n=s;return i-e[t]<=e[n]-i?t:n}function Kp(i){return(t,n,s)=>{let r=-1,o=-1;for(let a=n;a<=s;a++)if(i(t[a])){r=a;break}for(let a=s;a>=n;a--)if(i(t[a])){o=a;break}return[r,o]}}var Jp=i=>i!=null,jp=i=>i!=null&&i>0,vl=Kp(Jp),T_=Kp(jp);function C_(i,e,t,n=0,s=!1){let r=s?T_:vl,o=s?jp:Jp;[e,t]=r(i,e,t);let a=i[e],l=i[e];if(e>-1)if(n==1)a=i[e],l=i[t];else if(n==-1)a=i[t],l=i[e];else for(let c=e;c<=t;c++){let h=i[c];o(h)&&(h<a?a=h:h>l&&(l=h))}return[a??Wt,l??-Wt]}function bl(i,e,t,n){let s=Ap(i),r=Ap(e);i==e&&(s==-1?(i*=t,e/=t):(i/=t,e*=t));let o=t==10?Ss:Qp,a=s==1?bi:Ui,l=r==1?Ui:bi,c=a(o(Rn(i))),h=l(o(Rn(e))),u=io(t,c),f=io(t,h);return t==10&&(c<0&&(u=Xt(u,-c)),h<0&&(f=Xt(f,-h))),n||t==2?(i=u*s,e=f*r):(i=im(i,u),e=Ml(e,f)),[i,e]}function Lu(i,e,t,n){let s=bl(i,e,t,n);return i==0&&(s[0]=0),e==0&&(s[1]=0),s}var Du=.1,Sp={mode:3,pad:Du},ha={pad:0,soft:null,mode:0},R_={min:ha,max:ha};function _l(i,e,t,n){return Sl(t)?wp(i,e,t):(ha.pad=t,ha.soft=n?0:null,ha.mode=n?3:0,wp(i,e,R_))}function Et(i,e){return i??e}function I_(i,e,t){for(e=Et(e,0),t=Et(t,i.length-1);e<=t;){if(i[e]!=null)return!0;e++}return!1}function wp(i,e,t){let n=t.min,s=t.max,r=Et(n.pad,0),o=Et(s.pad,0),a=Et(n.hard,-Wt),l=Et(s.hard,Wt),c=Et(n.soft,Wt),h=Et(s.soft,-Wt),u=Et(n.mode,0),f=Et(s.mode,0),p=e-i,g=Ss(p),x=ai(Rn(i),Rn(e)),m=Ss(x),d=Rn(m-g);(p<1e-24||d>10)&&(p=0,(i==0||e==0)&&(p=1e-24,u==2&&c!=Wt&&(r=0),f==2&&h!=-Wt&&(o=0)));let y=p||x||1e3,w=Ss(y),v=io(10,bi(w)),E=y*(p==0?i==0?.1:1:r),S=Xt(im(i-E,v/10),24),_=i>=c&&(u==1||u==3&&S<=c||u==2&&S>=c)?c:Wt,M=ai(a,S<_&&i>=_?_:Wi(_,S)),D=y*(p==0?e==0?.1:1:o),I=Xt(Ml(e+D,v/10),24),L=e<=h&&(f==1||f==3&&I>=h||f==2&&I<=h)?h:-Wt,k=Wi(l,I>L&&e<=L?L:ai(L,I));return M==k&&M==0&&(k=100),[M,k]}var P_=new Intl.NumberFormat(ao?A_.language:"en-US"),Nu=i=>P_.format(i),Mi=Math,gl=Mi.PI,Rn=Mi.abs,bi=Mi.floor,Cn=Mi.round,Ui=Mi.ceil,Wi=Mi.min,ai=Mi.max,io=Mi.pow,Ap=Mi.sign,Ss=Mi.log10,Qp=Mi.log2,L_=(i,e=1)=>Mi.sinh(i)*e,mu=(i,e=1)=>Mi.asinh(i/e),Wt=1/0;function Ep(i){return(Ss((i^i>>31)-(i>>31))|0)+1}function Su(i,e,t){return Wi(ai(i,e),t)}function em(i){return typeof i=="function"}function vt(i){return em(i)?i:()=>i}var D_=()=>{},tm=i=>i,nm=(i,e)=>e,N_=i=>null,Tp=i=>!0,Cp=(i,e)=>i==e,U_=/\.\d*?(?=9{6,}|0{6,})/gm,xr=i=>{if(rm(i)||$s.has(i))return i;let e=`${i}`,t=e.match(U_);if(t==null)return i;let n=t[0].length-1;if(e.indexOf("e-")!=-1){let[s,r]=e.split("e");return+`${xr(s)}e${r}`}return Xt(i,n)};function mr(i,e){return xr(Xt(xr(i/e))*e)}function Ml(i,e){return xr(Ui(xr(i/e))*e)}function im(i,e){return xr(bi(xr(i/e))*e)}function Xt(i,e=0){if(rm(i))return i;let t=10**e,n=i*t*(1+Number.EPSILON);return Cn(n)/t}var $s=new Map;function sm(i){return((""+i).split(".")[1]||"").length}function fa(i,e,t,n){let s=[],r=n.map(sm);for(let o=e;o<t;o++){let a=Rn(o),l=Xt(io(i,o),a);for(let c=0;c<n.length;c++){let h=i==10?+`${n[c]}e${o}`:n[c]*l,u=(o>=0?0:a)+(o>=r[c]?0:r[c]),f=i==10?h:Xt(h,u);s.push(f),$s.set(f,u)}}return s}var ua={},Uu=[],so=[null,null],Xs=Array.isArray,rm=Number.isInteger,F_=i=>i===void 0;function Rp(i){return typeof i=="string"}function Sl(i){let e=!1;if(i!=null){let t=i.constructor;e=t==null||t==Object}return e}function O_(i){return i!=null&&typeof i=="object"}var k_=Object.getPrototypeOf(Uint8Array),om="__proto__";function ro(i,e=Sl){let t;if(Xs(i)){let n=i.find(s=>s!=null);if(Xs(n)||e(n)){t=Array(i.length);for(let s=0;s<i.length;s++)t[s]=ro(i[s],e)}else t=i.slice()}else if(i instanceof k_)t=i.slice();else if(e(i)){t={};for(let n in i)n!=om&&(t[n]=ro(i[n],e))}else t=i;return t}function Mn(i){let e=arguments;for(let t=1;t<e.length;t++){let n=e[t];for(let s in n)s!=om&&(Sl(i[s])?Mn(i[s],ro(n[s])):i[s]=ro(n[s]))}return i}var B_=0,z_=1,V_=2;function H_(i,e,t){for(let n=0,s,r=-1;n<e.length;n++){let o=e[n];if(o>r){for(s=o-1;s>=0&&i[s]==null;)i[s--]=null;for(s=o+1;s<t&&i[s]==null;)i[r=s++]=null}}}function G_(i,e){if($_(i)){let o=i[0].slice();for(let a=1;a<i.length;a++)o.push(...i[a].slice(1));return q_(o[0])||(o=X_(o)),o}let t=new Set;for(let o=0;o<i.length;o++){let l=i[o][0],c=l.length;for(let h=0;h<c;h++)t.add(l[h])}let n=[Array.from(t).sort((o,a)=>o-a)],s=n[0].length,r=new Map;for(let o=0;o<s;o++)r.set(n[0][o],o);for(let o=0;o<i.length;o++){let a=i[o],l=a[0];for(let c=1;c<a.length;c++){let h=a[c],u=Array(s).fill(void 0),f=e?e[o][c]:z_,p=[];for(let g=0;g<h.length;g++){let x=h[g],m=r.get(l[g]);x===null?f!=B_&&(u[m]=x,f==V_&&p.push(m)):u[m]=x}H_(u,p,s),n.push(u)}}return n}var W_=typeof queueMicrotask>"u"?i=>Promise.resolve().then(i):queueMicrotask;function X_(i){let e=i[0],t=e.length,n=Array(t);for(let r=0;r<n.length;r++)n[r]=r;n.sort((r,o)=>e[r]-e[o]);let s=[];for(let r=0;r<i.length;r++){let o=i[r],a=Array(t);for(let l=0;l<t;l++)a[l]=o[n[l]];s.push(a)}return s}function $_(i){let e=i[0][0],t=e.length;for(let n=1;n<i.length;n++){let s=i[n][0];if(s.length!=t)return!1;if(s!=e){for(let r=0;r<t;r++)if(s[r]!=e[r])return!1}}return!0}function q_(i,e=100){let t=i.length;if(t<=1)return!0;let n=0,s=t-1;for(;n<=s&&i[n]==null;)n++;for(;s>=n&&i[s]==null;)s--;if(s<=n)return!0;let r=ai(1,bi((s-n+1)/e));for(let o=i[n],a=n+r;a<=s;a+=r){let l=i[a];if(l!=null){if(l<=o)return!1;o=l}}return!0}var am=["January","February","March","April","May","June","July","August","September","October","November","December"],lm=["Sunday","Monday","Tuesday","Wednesday","Thursday","Friday","Saturday"];function cm(i){return i.slice(0,3)}var Y_=lm.map(cm),Z_=am.map(cm),K_={MMMM:am,MMM:Z_,WWWW:lm,WWW:Y_};function oa(i){return(i<10?"0":"")+i}function J_(i){return(i<10?"00":i<100?"0":"")+i}var j_={YYYY:i=>i.getFullYear(),YY:i=>(i.getFullYear()+"").slice(2),MMMM:(i,e)=>e.MMMM[i.getMonth()],MMM:(i,e)=>e.MMM[i.getMonth()],MM:i=>oa(i.getMonth()+1),M:i=>i.getMonth()+1,DD:i=>oa(i.getDate()),D:i=>i.getDate(),WWWW:(i,e)=>e.WWWW[i.getDay()],WWW:(i,e)=>e.WWW[i.getDay()],HH:i=>oa(i.getHours()),H:i=>i.getHours(),h:i=>{let e=i.getHours();return e==0?12:e>12?e-12:e},AA:i=>i.getHours()>=12?"PM":"AM",aa:i=>i.getHours()>=12?"pm":"am",a:i=>i.getHours()>=12?"p":"a",mm:i=>oa(i.getMinutes()),m:i=>i.getMinutes(),ss:i=>oa(i.getSeconds()),s:i=>i.getSeconds(),fff:i=>J_(i.getMilliseconds())};function Fu(i,e){e=e||K_;let t=[],n=/\{([a-z]+)\}|[^{]+/gi,s;for(;s=n.exec(i);)t.push(s[0][0]=="{"?j_[s[1]]:s[0]);return r=>{let o="";for(let a=0;a<t.length;a++)o+=typeof t[a]=="string"?t[a]:t[a](r,e);return o}}var Q_=new Intl.DateTimeFormat().resolvedOptions().timeZone;function ex(i,e){let t;return e=="UTC"||e=="Etc/UTC"?t=new Date(+i+i.getTimezoneOffset()*6e4):e==Q_?t=i:(t=new Date(i.toLocaleString("en-US",{timeZone:e})),t.setMilliseconds(i.getMilliseconds())),t}var hm=i=>i%1==0,xl=[1,2,2.5,5],tx=fa(10,-32,0,xl),um=fa(10,0,32,xl),nx=um.filter(hm),gr=tx.concat(um),Ou=`
`,fm="{YYYY}",Ip=Ou+fm,dm="{M}/{D}",ca=Ou+dm,pl=ca+"/{YY}",pm="{aa}",ix="{h}:{mm}",to=ix+pm,Pp=Ou+to,Lp=":{ss}",Pt=null;function mm(i){let e=i*1e3,t=e*60,n=t*60,s=n*24,r=s*30,o=s*365,l=(i==1?fa(10,0,3,xl).filter(hm):fa(10,-3,0,xl)).concat([e,e*5,e*10,e*15,e*30,t,t*5,t*10,t*15,t*30,n,n*2,n*3,n*4,n*6,n*8,n*12,s,s*2,s*3,s*4,s*5,s*6,s*7,s*8,s*9,s*10,s*15,r,r*2,r*3,r*4,r*6,o,o*2,o*5,o*10,o*25,o*50,o*100]),c=[[o,fm,Pt,Pt,Pt,Pt,Pt,Pt,1],[s*28,"{MMM}",Ip,Pt,Pt,Pt,Pt,Pt,1],[s,dm,Ip,Pt,Pt,Pt,Pt,Pt,1],[n,"{h}"+pm,pl,Pt,ca,Pt,Pt,Pt,1],[t,to,pl,Pt,ca,Pt,Pt,Pt,1],[e,Lp,pl+" "+to,Pt,ca+" "+to,Pt,Pp,Pt,1],[i,Lp+".{fff}",pl+" "+to,Pt,ca+" "+to,Pt,Pp,Pt,1]];function h(u){return(f,p,g,x,m,d)=>{let y=[],w=m>=o,v=m>=r&&m<o,E=u(g),S=Xt(E*i,3),_=gu(E.getFullYear(),w?0:E.getMonth(),v||w?1:E.getDate()),M=Xt(_*i,3);if(v||w){let D=v?m/r:0,I=w?m/o:0,L=S==M?S:Xt(gu(_.getFullYear()+I,_.getMonth()+D,1)*i,3),k=new Date(Cn(L/i)),V=k.getFullYear(),R=k.getMonth();for(let U=0;L<=x;U++){let X=gu(V+I*U,R+D*U,1),H=X-u(Xt(X*i,3));L=Xt((+X+H)*i,3),L<=x&&y.push(L)}}else{let D=m>=s?s:m,I=bi(g)-bi(S),L=M+I+Ml(S-M,D);y.push(L);let k=u(L),V=k.getHours()+k.getMinutes()/t+k.getSeconds()/n,R=m/n,U=f.axes[p]._space,X=d/U;for(;L=Xt(L+m,i==1?0:3),!(L>x);)if(R>1){let H=bi(Xt(V+R,6))%24,J=u(L).getHours()-H;J>1&&(J=-1),L-=J*n,V=(V+R)%24;let ee=y[y.length-1];Xt((L-ee)/m,3)*X>=.7&&y.push(L)}else y.push(L)}return y}}return[l,c,h]}var[sx,rx,ox]=mm(1),[ax,lx,cx]=mm(.001);fa(2,-53,53,[1]);function Dp(i,e){return i.map(t=>t.map((n,s)=>s==0||s==8||n==null?n:e(s==1||t[8]==0?n:t[1]+n)))}function Np(i,e){return(t,n,s,r,o)=>{let a=e.find(g=>o>=g[0])||e[e.length-1],l,c,h,u,f,p;return n.map(g=>{let x=i(g),m=x.getFullYear(),d=x.getMonth(),y=x.getDate(),w=x.getHours(),v=x.getMinutes(),E=x.getSeconds(),S=m!=l&&a[2]||d!=c&&a[3]||y!=h&&a[4]||w!=u&&a[5]||v!=f&&a[6]||E!=p&&a[7]||a[1];return l=m,c=d,h=y,u=w,f=v,p=E,S(x)})}}function hx(i,e){let t=Fu(e);return(n,s,r,o,a)=>s.map(l=>t(i(l)))}function gu(i,e,t){return new Date(i,e,t)}function Up(i,e){return e(i)}var ux="{YYYY}-{MM}-{DD} {h}:{mm}{aa}";function Fp(i,e){return(t,n,s,r)=>r==null?Iu:e(i(n))}function fx(i,e){let t=i.series[e];return t.width?t.stroke(i,e):t.points.width?t.points.stroke(i,e):null}function dx(i,e){return i.series[e].fill(i,e)}var px={show:!0,live:!0,isolate:!1,mount:D_,markers:{show:!0,width:2,stroke:fx,fill:dx,dash:"solid"},idx:null,idxs:null,values:[]};function mx(i,e){let t=i.cursor.points,n=Ni(),s=t.size(i,e);Jt(n,aa,s),Jt(n,la,s);let r=s/-2;Jt(n,"marginLeft",r),Jt(n,"marginTop",r);let o=t.width(i,e,s);return o&&Jt(n,"borderWidth",o),n}function gx(i,e){let t=i.series[e].points;return t._fill||t._stroke}function yx(i,e){let t=i.series[e].points;return t._stroke||t._fill}function _x(i,e){return i.series[e].points.size}var yu=[0,0];function xx(i,e,t){return yu[0]=e,yu[1]=t,yu}function ml(i,e,t,n=!0){return s=>{s.button==0&&(!n||s.target==e)&&t(s)}}function _u(i,e,t,n=!0){return s=>{(!n||s.target==e)&&t(s)}}var vx={show:!0,x:!0,y:!0,lock:!1,move:xx,points:{one:!1,show:mx,size:_x,width:0,stroke:yx,fill:gx},bind:{mousedown:ml,mouseup:ml,click:ml,dblclick:ml,mousemove:_u,mouseleave:_u,mouseenter:_u},drag:{setScale:!0,x:!0,y:!1,dist:0,uni:null,click:(i,e)=>{e.stopPropagation(),e.stopImmediatePropagation()},_x:!1,_y:!1},focus:{dist:(i,e,t,n,s)=>n-s,prox:-1,bias:0},hover:{skip:[void 0],prox:null,bias:0},left:-10,top:-10,idx:null,dataIdx:null,idxs:null,event:null},gm={show:!0,stroke:"rgba(0,0,0,0.07)",width:2},ku=Mn({},gm,{filter:nm}),ym=Mn({},ku,{size:10}),_m=Mn({},gm,{show:!1}),Bu='12px system-ui, -apple-system, "Segoe UI", Roboto, "Helvetica Neue", Arial, "Noto Sans", sans-serif, "Apple Color Emoji", "Segoe UI Emoji", "Segoe UI Symbol", "Noto Color Emoji"',xm="bold "+Bu,vm=1.5,Op={show:!0,scale:"x",stroke:Ru,space:50,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:xm,side:2,grid:ku,ticks:ym,border:_m,font:Bu,lineGap:vm,rotate:0},bx="Value",Mx="Time",kp={show:!0,scale:"x",auto:!1,sorted:1,min:Wt,max:-Wt,idxs:[]};function Sx(i,e,t,n,s){return e.map(r=>r==null?"":Nu(r))}function wx(i,e,t,n,s,r,o){let a=[],l=$s.get(s)||0;t=o?t:Xt(Ml(t,s),l);for(let c=t;c<=n;c=Xt(c+s,l))a.push(Object.is(c,-0)?0:c);return a}function wu(i,e,t,n,s,r,o){let a=[],l=i.scales[i.axes[e].scale].log,c=l==10?Ss:Qp,h=bi(c(t));s=io(l,h),l==10&&(s=gr[Gi(s,gr)]);let u=t,f=s*l;l==10&&(f=gr[Gi(f,gr)]);do a.push(u),u=u+s,l==10&&!$s.has(u)&&(u=Xt(u,$s.get(s))),u>=f&&(s=u,f=s*l,l==10&&(f=gr[Gi(f,gr)]));while(u<=n);return a}function Ax(i,e,t,n,s,r,o){let l=i.scales[i.axes[e].scale].asinh,c=n>l?wu(i,e,ai(l,t),n,s):[l],h=n>=0&&t<=0?[0]:[];return(t<-l?wu(i,e,ai(l,-n),-t,s):[l]).reverse().map(f=>-f).concat(h,c)}var bm=/./,Ex=/[12357]/,Tx=/[125]/,Bp=/1/,Au=(i,e,t,n)=>i.map((s,r)=>e==4&&s==0||r%n==0&&t.test(s.toExponential()[s<0?1:0])?s:null);function Cx(i,e,t,n,s){let r=i.axes[t],o=r.scale,a=i.scales[o],l=i.valToPos,c=r._space,h=l(10,o),u=l(9,o)-h>=c?bm:l(7,o)-h>=c?Ex:l(5,o)-h>=c?Tx:Bp;if(u==Bp){let f=Rn(l(1,o)-h);if(f<c)return Au(e.slice().reverse(),a.distr,u,Ui(c/f)).reverse()}return Au(e,a.distr,u,1)}function Rx(i,e,t,n,s){let r=i.axes[t],o=r.scale,a=r._space,l=i.valToPos,c=Rn(l(1,o)-l(2,o));return c<a?Au(e.slice().reverse(),3,bm,Ui(a/c)).reverse():e}function Ix(i,e,t,n){return n==null?Iu:e==null?"":Nu(e)}var zp={show:!0,scale:"y",stroke:Ru,space:30,gap:5,alignTo:1,size:50,labelGap:0,labelSize:30,labelFont:xm,side:3,grid:ku,ticks:ym,border:_m,font:Bu,lineGap:vm,rotate:0};function Px(i,e){let t=3+(i||1)*2;return Xt(t*e,3)}function Lx(i,e){let{scale:t,idxs:n}=i.series[0],s=i._data[0],r=i.valToPos(s[n[0]],t,!0),o=i.valToPos(s[n[1]],t,!0),a=Rn(o-r),l=i.series[e],c=a/(l.points.space*Rt);return n[1]-n[0]<=c}var Vp={scale:null,auto:!0,sorted:0,min:Wt,max:-Wt},Mm=(i,e,t,n,s)=>s,Hp={show:!0,auto:!0,sorted:0,gaps:Mm,alpha:1,facets:[Mn({},Vp,{scale:"x"}),Mn({},Vp,{scale:"y"})]},Gp={scale:"y",auto:!0,sorted:0,show:!0,spanGaps:!1,gaps:Mm,alpha:1,points:{show:Lx,filter:null},values:null,min:Wt,max:-Wt,idxs:[],path:null,clip:null};function Dx(i,e,t,n,s){return t/10}var Sm={time:!0,auto:!0,distr:1,log:10,asinh:1,min:null,max:null,dir:1,ori:0},Nx=Mn({},Sm,{time:!1,ori:1}),Wp={};function wm(i,e){let t=Wp[i];return t||(t={key:i,plots:[],sub(n){t.plots.push(n)},unsub(n){t.plots=t.plots.filter(s=>s!=n)},pub(n,s,r,o,a,l,c){for(let h=0;h<t.plots.length;h++)t.plots[h]!=s&&t.plots[h].pub(n,s,r,o,a,l,c)}},i!=null&&(Wp[i]=t)),t}var oo=1,Eu=2;function vr(i,e,t){let n=i.mode,s=i.series[e],r=n==2?i._data[e]:i._data,o=i.scales,a=i.bbox,l=r[0],c=n==2?r[1]:r[e],h=n==2?o[s.facets[0].scale]:o[i.series[0].scale],u=n==2?o[s.facets[1].scale]:o[s.scale],f=a.left,p=a.top,g=a.width,x=a.height,m=i.valToPosH,d=i.valToPosV;return h.ori==0?t(s,l,c,h,u,m,d,f,p,g,x,Al,lo,Tl,Em,Cm):t(s,l,c,h,u,d,m,p,f,x,g,El,co,Hu,Tm,Rm)}function zu(i,e){let t=0,n=0,s=Et(i.bands,Uu);for(let r=0;r<s.length;r++){let o=s[r];o.series[0]==e?t=o.dir:o.series[1]==e&&(o.dir==1?n|=1:n|=2)}return[t,n==1?-1:n==2?1:n==3?2:0]}function Ux(i,e,t,n,s){let r=i.mode,o=i.series[e],a=r==2?o.facets[1].scale:o.scale,l=i.scales[a];return s==-1?l.min:s==1?l.max:l.distr==3?l.dir==1?l.min:l.max:0}function ws(i,e,t,n,s,r){return vr(i,e,(o,a,l,c,h,u,f,p,g,x,m)=>{let d=o.pxRound,y=c.dir*(c.ori==0?1:-1),w=c.ori==0?lo:co,v,E;y==1?(v=t,E=n):(v=n,E=t);let S=d(u(a[v],c,x,p)),_=d(f(l[v],h,m,g)),M=d(u(a[E],c,x,p)),D=d(f(r==1?h.max:h.min,h,m,g)),I=new Path2D(s);return w(I,M,D),w(I,S,D),w(I,S,_),I})}function wl(i,e,t,n,s,r){let o=null;if(i.length>0){o=new Path2D;let a=e==0?Tl:Hu,l=t;for(let u=0;u<i.length;u++){let f=i[u];if(f[1]>f[0]){let p=f[0]-l;p>0&&a(o,l,n,p,n+r),l=f[1]}}let c=t+s-l,h=10;c>0&&a(o,l,n-h/2,c,n+r+h)}return o}function Fx(i,e,t){let n=i[i.length-1];n&&n[0]==e?n[1]=t:i.push([e,t])}function Vu(i,e,t,n,s,r,o){let a=[],l=i.length;for(let c=s==1?t:n;c>=t&&c<=n;c+=s)if(e[c]===null){let u=c,f=c;if(s==1)for(;++c<=n&&e[c]===null;)f=c;else for(;--c>=t&&e[c]===null;)f=c;let p=r(i[u]),g=f==u?p:r(i[f]),x=u-s;p=o<=0&&x>=0&&x<l?r(i[x]):p;let d=f+s;g=o>=0&&d>=0&&d<l?r(i[d]):g,g>=p&&a.push([p,g])}return a}function Xp(i){return i==0?tm:i==1?Cn:e=>mr(e,i)}function Am(i){let e=i==0?Al:El,t=i==0?(s,r,o,a,l,c)=>{s.arcTo(r,o,a,l,c)}:(s,r,o,a,l,c)=>{s.arcTo(o,r,l,a,c)},n=i==0?(s,r,o,a,l)=>{s.rect(r,o,a,l)}:(s,r,o,a,l)=>{s.rect(o,r,l,a)};return(s,r,o,a,l,c=0,h=0)=>{c==0&&h==0?n(s,r,o,a,l):(c=Wi(c,a/2,l/2),h=Wi(h,a/2,l/2),e(s,r+c,o),t(s,r+a,o,r+a,o+l,c),t(s,r+a,o+l,r,o+l,h),t(s,r,o+l,r,o,h),t(s,r,o,r+a,o,c),s.closePath())}}var Al=(i,e,t)=>{i.moveTo(e,t)},El=(i,e,t)=>{i.moveTo(t,e)},lo=(i,e,t)=>{i.lineTo(e,t)},co=(i,e,t)=>{i.lineTo(t,e)},Tl=Am(0),Hu=Am(1),Em=(i,e,t,n,s,r)=>{i.arc(e,t,n,s,r)},Tm=(i,e,t,n,s,r)=>{i.arc(t,e,n,s,r)},Cm=(i,e,t,n,s,r,o)=>{i.bezierCurveTo(e,t,n,s,r,o)},Rm=(i,e,t,n,s,r,o)=>{i.bezierCurveTo(t,e,s,n,o,r)};function Im(i){return(e,t,n,s,r)=>vr(e,t,(o,a,l,c,h,u,f,p,g,x,m)=>{let{pxRound:d,points:y}=o,w,v;c.ori==0?(w=Al,v=Em):(w=El,v=Tm);let E=Xt(y.width*Rt,3),S=(y.size-y.width)/2*Rt,_=Xt(S*2,3),M=new Path2D,D=new Path2D,{left:I,top:L,width:k,height:V}=e.bbox;Tl(D,I-_,L-_,k+_*2,V+_*2);let R=U=>{if(l[U]!=null){let X=d(u(a[U],c,x,p)),H=d(f(l[U],h,m,g));w(M,X+S,H),v(M,X,H,S,0,gl*2)}};if(r)r.forEach(R);else for(let U=n;U<=s;U++)R(U);return{stroke:E>0?M:null,fill:M,clip:D,flags:oo|Eu}})}function Pm(i){return(e,t,n,s,r,o)=>{n!=s&&(r!=n&&o!=n&&i(e,t,n),r!=s&&o!=s&&i(e,t,s),i(e,t,o))}}var Ox=Pm(lo),kx=Pm(co);function Lm(i){let e=Et(i?.alignGaps,0);return(t,n,s,r)=>vr(t,n,(o,a,l,c,h,u,f,p,g,x,m)=>{[s,r]=vl(l,s,r);let d=o.pxRound,y=V=>d(u(V,c,x,p)),w=V=>d(f(V,h,m,g)),v,E;c.ori==0?(v=lo,E=Ox):(v=co,E=kx);let S=c.dir*(c.ori==0?1:-1),_={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:oo},M=_.stroke,D=!1;if(r-s>=x*4){let V=ue=>t.posToVal(ue,c.key,!0),R=null,U=null,X,H,ae,Y=y(a[S==1?s:r]),J=y(a[s]),ee=y(a[r]),fe=V(S==1?J+1:ee-1);for(let ue=S==1?s:r;ue>=s&&ue<=r;ue+=S){let Q=a[ue],ge=(S==1?Q<fe:Q>fe)?Y:y(Q),_e=l[ue];ge==Y?_e!=null?(H=_e,R==null?(v(M,ge,w(H)),X=R=U=H):H<R?R=H:H>U&&(U=H)):_e===null&&(D=!0):(R!=null&&E(M,Y,w(R),w(U),w(X),w(H)),_e!=null?(H=_e,v(M,ge,w(H)),R=U=X=H):(R=U=null,_e===null&&(D=!0)),Y=ge,fe=V(Y+S))}R!=null&&R!=U&&ae!=Y&&E(M,Y,w(R),w(U),w(X),w(H))}else for(let V=S==1?s:r;V>=s&&V<=r;V+=S){let R=l[V];R===null?D=!0:R!=null&&v(M,y(a[V]),w(R))}let[L,k]=zu(t,n);if(o.fill!=null||L!=0){let V=_.fill=new Path2D(M),R=o.fillTo(t,n,o.min,o.max,L),U=w(R),X=y(a[s]),H=y(a[r]);S==-1&&([H,X]=[X,H]),v(V,H,U),v(V,X,U)}if(!o.spanGaps){let V=[];D&&V.push(...Vu(a,l,s,r,S,y,e)),_.gaps=V=o.gaps(t,n,s,r,V),_.clip=wl(V,c.ori,p,g,x,m)}return k!=0&&(_.band=k==2?[ws(t,n,s,r,M,-1),ws(t,n,s,r,M,1)]:ws(t,n,s,r,M,k)),_})}function Bx(i){let e=Et(i.align,1),t=Et(i.ascDesc,!1),n=Et(i.alignGaps,0),s=Et(i.extend,!1);return(r,o,a,l)=>vr(r,o,(c,h,u,f,p,g,x,m,d,y,w)=>{[a,l]=vl(u,a,l);let v=c.pxRound,{left:E,width:S}=r.bbox,_=J=>v(g(J,f,y,m)),M=J=>v(x(J,p,w,d)),D=f.ori==0?lo:co,I={stroke:new Path2D,fill:null,clip:null,band:null,gaps:null,flags:oo},L=I.stroke,k=f.dir*(f.ori==0?1:-1),V=M(u[k==1?a:l]),R=_(h[k==1?a:l]),U=R,X=R;s&&e==-1&&(X=E,D(L,X,V)),D(L,R,V);for(let J=k==1?a:l;J>=a&&J<=l;J+=k){let ee=u[J];if(ee==null)continue;let fe=_(h[J]),ue=M(ee);e==1?D(L,fe,V):D(L,U,ue),D(L,fe,ue),V=ue,U=fe}let H=U;s&&e==1&&(H=E+S,D(L,H,V));let[ae,Y]=zu(r,o);if(c.fill!=null||ae!=0){let J=I.fill=new Path2D(L),ee=c.fillTo(r,o,c.min,c.max,ae),fe=M(ee);D(J,H,fe),D(J,X,fe)}if(!c.spanGaps){let J=[];J.push(...Vu(h,u,a,l,k,_,n));let ee=c.width*Rt/2,fe=t||e==1?ee:-ee,ue=t||e==-1?-ee:ee;J.forEach(Q=>{Q[0]+=fe,Q[1]+=ue}),I.gaps=J=c.gaps(r,o,a,l,J),I.clip=wl(J,f.ori,m,d,y,w)}return Y!=0&&(I.band=Y==2?[ws(r,o,a,l,L,-1),ws(r,o,a,l,L,1)]:ws(r,o,a,l,L,Y)),I})}function $p(i,e,t,n,s,r,o=Wt){if(i.length>1){let a=null;for(let l=0,c=1/0;l<i.length;l++)if(e[l]!==void 0){if(a!=null){let h=Rn(i[l]-i[a]);h<c&&(c=h,o=Rn(t(i[l],n,s,r)-t(i[a],n,s,r)))}a=l}}return o}function zx(i){i=i||ua;let e=Et(i.size,[.6,Wt,1]),t=i.align||0,n=i.gap||0,s=i.radius;s=s==null?[0,0]:typeof s=="number"?[s,0]:s;let r=vt(s),o=1-e[0],a=Et(e[1],Wt),l=Et(e[2],1),c=Et(i.disp,ua),h=Et(i.each,p=>{}),{fill:u,stroke:f}=c;return(p,g,x,m)=>vr(p,g,(d,y,w,v,E,S,_,M,D,I,L)=>{let k=d.pxRound,V=t,R=n*Rt,U=a*Rt,X=l*Rt,H,ae;v.ori==0?[H,ae]=r(p,g):[ae,H]=r(p,g);let Y=v.dir*(v.ori==0?1:-1),J=v.ori==0?Tl:Hu,ee=v.ori==0?h:(Re,Ze,ot,we,Gt,Ge,$e)=>{h(Re,Ze,ot,Gt,we,$e,Ge)},fe=Et(p.bands,Uu).find(Re=>Re.series[0]==g),ue=fe!=null?fe.dir:0,Q=d.fillTo(p,g,d.min,d.max,ue),me=k(_(Q,E,L,D)),ge,_e,ye,He=I,Ke=k(d.width*Rt),Oe=!1,it=null,at=null,st=null,Qt=null;u!=null&&(Ke==0||f!=null)&&(Oe=!0,it=u.values(p,g,x,m),at=new Map,new Set(it).forEach(Re=>{Re!=null&&at.set(Re,new Path2D)}),Ke>0&&(st=f.values(p,g,x,m),Qt=new Map,new Set(st).forEach(Re=>{Re!=null&&Qt.set(Re,new Path2D)})));let{x0:$t,size:gn}=c;if($t!=null&&gn!=null){V=1,y=$t.values(p,g,x,m),$t.unit==2&&(y=y.map(ot=>p.posToVal(M+ot*I,v.key,!0)));let Re=gn.values(p,g,x,m);gn.unit==2?_e=Re[0]*I:_e=S(Re[0],v,I,M)-S(0,v,I,M),He=$p(y,w,S,v,I,M,He),ye=He-_e+R}else He=$p(y,w,S,v,I,M,He),ye=He*o+R,_e=He-ye;ye<1&&(ye=0),Ke>=_e/2&&(Ke=0),ye<5&&(k=tm);let Bt=ye>0,Dn=He-ye-(Bt?Ke:0);_e=k(Su(Dn,X,U)),ge=(V==0?_e/2:V==Y?0:_e)-V*Y*((V==0?R/2:0)+(Bt?Ke/2:0));let St={stroke:null,fill:null,clip:null,band:null,gaps:null,flags:0},En=Oe?null:new Path2D,an=null;if(fe!=null)an=p.data[fe.series[1]];else{let{y0:Re,y1:Ze}=c;Re!=null&&Ze!=null&&(w=Ze.values(p,g,x,m),an=Re.values(p,g,x,m))}let yn=H*_e,z=ae*_e;for(let Re=Y==1?x:m;Re>=x&&Re<=m;Re+=Y){let Ze=w[Re];if(Ze==null)continue;if(an!=null){let $=an[Re]??0;if(Ze-$==0)continue;me=_($,E,L,D)}let ot=v.distr!=2||c!=null?y[Re]:Re,we=S(ot,v,I,M),Gt=_(Et(Ze,Q),E,L,D),Ge=k(we-ge),$e=k(ai(Gt,me)),P=k(Wi(Gt,me)),A=$e-P;if(Ze!=null){let $=Ze<0?z:yn,he=Ze<0?yn:z;Oe?(Ke>0&&st[Re]!=null&&J(Qt.get(st[Re]),Ge,P+bi(Ke/2),_e,ai(0,A-Ke),$,he),it[Re]!=null&&J(at.get(it[Re]),Ge,P+bi(Ke/2),_e,ai(0,A-Ke),$,he)):J(En,Ge,P+bi(Ke/2),_e,ai(0,A-Ke),$,he),ee(p,g,Re,Ge-Ke/2,P,_e+Ke,A)}}return Ke>0?St.stroke=Oe?Qt:En:Oe||(St._fill=d.width==0?d._fill:d._stroke??d._fill,St.width=0),St.fill=Oe?at:En,St})}function Vx(i,e){let t=Et(e?.alignGaps,0);return(n,s,r,o)=>vr(n,s,(a,l,c,h,u,f,p,g,x,m,d)=>{[r,o]=vl(c,r,o);let y=a.pxRound,w=H=>y(f(H,h,m,g)),v=H=>y(p(H,u,d,x)),E,S,_;h.ori==0?(E=Al,_=lo,S=Cm):(E=El,_=co,S=Rm);let M=h.dir*(h.ori==0?1:-1),D=w(l[M==1?r:o]),I=D,L=[],k=[];for(let H=M==1?r:o;H>=r&&H<=o;H+=M)if(c[H]!=null){let Y=l[H],J=w(Y);L.push(I=J),k.push(v(c[H]))}let V={stroke:i(L,k,E,_,S,y),fill:null,clip:null,band:null,gaps:null,flags:oo},R=V.stroke,[U,X]=zu(n,s);if(a.fill!=null||U!=0){let H=V.fill=new Path2D(R),ae=a.fillTo(n,s,a.min,a.max,U),Y=v(ae);_(H,I,Y),_(H,D,Y)}if(!a.spanGaps){let H=[];H.push(...Vu(l,c,r,o,M,w,t)),V.gaps=H=a.gaps(n,s,r,o,H),V.clip=wl(H,h.ori,g,x,m,d)}return X!=0&&(V.band=X==2?[ws(n,s,r,o,R,-1),ws(n,s,r,o,R,1)]:ws(n,s,r,o,R,X)),V})}function Hx(i){return Vx(Gx,i)}function Gx(i,e,t,n,s,r){let o=i.length;if(o<2)return null;let a=new Path2D;if(t(a,i[0],e[0]),o==2)n(a,i[1],e[1]);else{let l=Array(o),c=Array(o-1),h=Array(o-1),u=Array(o-1);for(let f=0;f<o-1;f++)h[f]=e[f+1]-e[f],u[f]=i[f+1]-i[f],c[f]=h[f]/u[f];l[0]=c[0];for(let f=1;f<o-1;f++)c[f]===0||c[f-1]===0||c[f-1]>0!=c[f]>0?l[f]=0:(l[f]=3*(u[f-1]+u[f])/((2*u[f]+u[f-1])/c[f-1]+(u[f]+2*u[f-1])/c[f]),isFinite(l[f])||(l[f]=0));l[o-1]=c[o-2];for(let f=0;f<o-1;f++)s(a,i[f]+u[f]/3,e[f]+l[f]*u[f]/3,i[f+1]-u[f]/3,e[f+1]-l[f+1]*u[f]/3,i[f+1],e[f+1])}return a}var Tu=new Set;function qp(){for(let i of Tu)i.syncRect(!0)}ao&&(_r(S_,no,qp),_r(w_,no,qp,!0),_r(yl,no,()=>{Gn.pxRatio=Rt}));var Wx=Lm(),Xx=Im();function Yp(i,e,t,n){return(n?[i[0],i[1]].concat(i.slice(2)):[i[0]].concat(i.slice(1))).map((r,o)=>Cu(r,o,e,t))}function $x(i,e){return i.map((t,n)=>n==0?{}:Mn({},e,t))}function Cu(i,e,t,n){return Mn({},e==0?t:n,i)}function Dm(i,e,t){return e==null?so:[e,t]}var qx=Dm;function Yx(i,e,t){return e==null?so:_l(e,t,Du,!0)}function Nm(i,e,t,n){return e==null?so:bl(e,t,i.scales[n].log,!1)}var Zx=Nm;function Um(i,e,t,n){return e==null?so:Lu(e,t,i.scales[n].log,!1)}var Kx=Um;function Jx(i,e,t,n,s){let r=ai(Ep(i),Ep(e)),o=e-i,a=Gi(s/n*o,t);do{let l=t[a],c=n*l/o;if(c>=s&&r+(l<5?$s.get(l):0)<=17)return[l,c]}while(++a<t.length);return[0,0]}function Zp(i){let e,t;return i=i.replace(/(\d+)px/,(n,s)=>(e=Cn((t=+s)*Rt))+"px"),[i,e,t]}function jx(i){i.show&&[i.font,i.labelFont].forEach(e=>{let t=Xt(e[2]*Rt,1);e[0]=e[0].replace(/[0-9.]+px/,t+"px"),e[1]=t})}function Gn(i,e,t){let n={mode:Et(i.mode,1)},s=n.mode;function r(b,T,N,F){let W=T.valToPct(b);return F+N*(T.dir==-1?1-W:W)}function o(b,T,N,F){let W=T.valToPct(b);return F+N*(T.dir==-1?W:1-W)}function a(b,T,N,F){return T.ori==0?r(b,T,N,F):o(b,T,N,F)}n.valToPosH=r,n.valToPosV=o;let l=!1;n.status=0;let c=n.root=Ni(r_);if(i.id!=null&&(c.id=i.id),vi(c,i.class),i.title){let b=Ni(l_,c);b.textContent=i.title}let h=Hi("canvas"),u=n.ctx=h.getContext("2d"),f=Ni(c_,c);_r("click",f,b=>{b.target===g&&(Yt!=Zr||en!=Kr)&&Hn.click(n,b)},!0);let p=n.under=Ni(h_,f);f.appendChild(h);let g=n.over=Ni(u_,f);i=ro(i);let x=+Et(i.pxAlign,1),m=Xp(x);(i.plugins||[]).forEach(b=>{b.opts&&(i=b.opts(n,i)||i)});let d=i.ms||.001,y=n.series=s==1?Yp(i.series||[],kp,Gp,!1):$x(i.series||[null],Hp),w=n.axes=Yp(i.axes||[],Op,zp,!0),v=n.scales={},E=n.bands=i.bands||[];E.forEach(b=>{b.fill=vt(b.fill||null),b.dir=Et(b.dir,-1)});let S=s==2?y[1].facets[0].scale:y[0].scale,_={axes:bs,series:mt},M=(i.drawOrder||["axes","series"]).map(b=>_[b]);function D(b){let T=b.distr==3?N=>Ss(N>0?N:b.clamp(n,N,b.min,b.max,b.key)):b.distr==4?N=>mu(N,b.asinh):b.distr==100?N=>b.fwd(N):N=>N;return N=>{let F=T(N),{_min:W,_max:K}=b,le=K-W;return(F-W)/le}}function I(b){let T=v[b];if(T==null){let N=(i.scales||ua)[b]||ua;if(N.from!=null){I(N.from);let F=Mn({},v[N.from],N,{key:b});F.valToPct=D(F),v[b]=F}else{T=v[b]=Mn({},b==S?Sm:Nx,N),T.key=b;let F=T.time,W=T.range,K=Xs(W);if((b!=S||s==2&&!F)&&(K&&(W[0]==null||W[1]==null)&&(W={min:W[0]==null?Sp:{mode:1,hard:W[0],soft:W[0]},max:W[1]==null?Sp:{mode:1,hard:W[1],soft:W[1]}},K=!1),!K&&Sl(W))){let le=W;W=(de,Me,De)=>Me==null?so:_l(Me,De,le)}T.range=vt(W||(F?qx:b==S?T.distr==3?Zx:T.distr==4?Kx:Dm:T.distr==3?Nm:T.distr==4?Um:Yx)),T.auto=vt(K?!1:T.auto),T.clamp=vt(T.clamp||Dx),T._min=T._max=null,T.valToPct=D(T)}}}I("x"),I("y"),s==1&&y.forEach(b=>{I(b.scale)}),w.forEach(b=>{I(b.scale)});for(let b in i.scales)I(b);let L=v[S],k=L.distr,V,R;L.ori==0?(vi(c,o_),V=r,R=o):(vi(c,a_),V=o,R=r);let U={};for(let b in v){let T=v[b];(T.min!=null||T.max!=null)&&(U[b]={min:T.min,max:T.max},T.min=T.max=null)}let X=i.tzDate||(b=>new Date(Cn(b/d))),H=i.fmtDate||Fu,ae=d==1?ox(X):cx(X),Y=Np(X,Dp(d==1?rx:lx,H)),J=Fp(X,Up(ux,H)),ee=[],fe=n.legend=Mn({},px,i.legend),ue=n.cursor=Mn({},vx,{drag:{y:s==2}},i.cursor),Q=fe.show,me=ue.show,ge=fe.markers;fe.idxs=ee,ge.width=vt(ge.width),ge.dash=vt(ge.dash),ge.stroke=vt(ge.stroke),ge.fill=vt(ge.fill);let _e,ye,He,Ke=[],Oe=[],it,at=!1,st={};if(fe.live){let b=y[1]?y[1].values:null;at=b!=null,it=at?b(n,1,0):{_:0};for(let T in it)st[T]=Iu}if(Q)if(_e=Hi("table",y_,c),He=Hi("tbody",null,_e),fe.mount(n,_e),at){ye=Hi("thead",null,_e,He);let b=Hi("tr",null,ye);Hi("th",null,b);for(var Qt in it)Hi("th",hp,b).textContent=Qt}else vi(_e,x_),fe.live&&vi(_e,__);let $t={show:!0},gn={show:!1};function Bt(b,T){if(T==0&&(at||!fe.live||s==2))return so;let N=[],F=Hi("tr",v_,He,He.childNodes[T]);vi(F,b.class),b.show||vi(F,yr);let W=Hi("th",null,F);if(ge.show){let de=Ni(b_,W);if(T>0){let Me=ge.width(n,T);Me&&(de.style.border=Me+"px "+ge.dash(n,T)+" "+ge.stroke(n,T)),de.style.background=ge.fill(n,T)}}let K=Ni(hp,W);b.label instanceof HTMLElement?K.appendChild(b.label):K.textContent=b.label,T>0&&(ge.show||(K.style.color=b.width>0?ge.stroke(n,T):ge.fill(n,T)),St("click",W,de=>{if(ue._lock)return;je(de);let Me=y.indexOf(b);if((de.ctrlKey||de.metaKey)!=fe.isolate){let De=y.some((Ne,ke)=>ke>0&&ke!=Me&&Ne.show);y.forEach((Ne,ke)=>{ke>0&&ss(ke,De?ke==Me?$t:gn:$t,!0,bn.setSeries)})}else ss(Me,{show:!b.show},!0,bn.setSeries)},!1),Qe&&St(pp,W,de=>{ue._lock||(je(de),ss(y.indexOf(b),jr,!0,bn.setSeries))},!1));for(var le in it){let de=Hi("td",M_,F);de.textContent="--",N.push(de)}return[F,N]}let Dn=new Map;function St(b,T,N,F=!0){let W=Dn.get(T)||{},K=ue.bind[b](n,T,N,F);K&&(_r(b,T,W[b]=K),Dn.set(T,W))}function En(b,T,N){let F=Dn.get(T)||{};for(let W in F)(b==null||W==b)&&(Mu(W,T,F[W]),delete F[W]);b==null&&Dn.delete(T)}let an=0,yn=0,z=0,Re=0,Ze=0,ot=0,we=Ze,Gt=ot,Ge=z,$e=Re,P=0,A=0,$=0,he=0;n.bbox={};let re=!1,ve=!1,be=!1,te=!1,ie=!1,pe=!1;function B(b,T,N){(N||b!=n.width||T!=n.height)&&se(b,T),ht(!1),be=!0,ve=!0,qn()}function se(b,T){n.width=an=z=b,n.height=yn=Re=T,Ze=ot=0,Se(),We();let N=n.bbox;P=N.left=mr(Ze*Rt,.5),A=N.top=mr(ot*Rt,.5),$=N.width=mr(z*Rt,.5),he=N.height=mr(Re*Rt,.5)}let ne=3;function Ae(){let b=!1,T=0;for(;!b;){T++;let N=$r(T),F=is(T);b=T==ne||N&&F,b||(se(n.width,n.height),ve=!0)}}function xe({width:b,height:T}){B(b,T)}n.setSize=xe;function Se(){let b=!1,T=!1,N=!1,F=!1;w.forEach((W,K)=>{if(W.show&&W._show){let{side:le,_size:de}=W,Me=le%2,De=W.label!=null?W.labelSize:0,Ne=de+De;Ne>0&&(Me?(z-=Ne,le==3?(Ze+=Ne,F=!0):N=!0):(Re-=Ne,le==0?(ot+=Ne,b=!0):T=!0))}}),ts[0]=b,ts[1]=N,ts[2]=T,ts[3]=F,z-=Bi[1]+Bi[3],Ze+=Bi[3],Re-=Bi[2]+Bi[0],ot+=Bi[0]}function We(){let b=Ze+z,T=ot+Re,N=Ze,F=ot;function W(K,le){switch(K){case 1:return b+=le,b-le;case 2:return T+=le,T-le;case 3:return N-=le,N+le;case 0:return F-=le,F+le}}w.forEach((K,le)=>{if(K.show&&K._show){let de=K.side;K._pos=W(de,K._size),K.label!=null&&(K._lpos=W(de,K.labelSize))}})}if(ue.dataIdx==null){let b=ue.hover,T=b.skip=new Set(b.skip??[]);T.add(void 0);let N=b.prox=vt(b.prox),F=b.bias??=0;ue.dataIdx=(W,K,le,de)=>{if(K==0)return le;let Me=le,De=N(W,K,le,de)??Wt,Ne=De>=0&&De<Wt,ke=L.ori==0?z:Re,rt=ue.left,Ct=e[0],At=e[K];if(T.has(At[le])){Me=null;let yt=null,Je=null,Xe;if(F==0||F==-1)for(Xe=le;yt==null&&Xe-- >0;)T.has(At[Xe])||(yt=Xe);if(F==0||F==1)for(Xe=le;Je==null&&Xe++<At.length;)T.has(At[Xe])||(Je=Xe);if(yt!=null||Je!=null)if(Ne){let Kt=yt==null?-1/0:V(Ct[yt],L,ke,0),hn=Je==null?1/0:V(Ct[Je],L,ke,0),On=rt-Kt,zt=hn-rt;On<=zt?On<=De&&(Me=yt):zt<=De&&(Me=Je)}else Me=Je==null?yt:yt==null?Je:le-yt<=Je-le?yt:Je}else Ne&&Rn(rt-V(Ct[le],L,ke,0))>De&&(Me=null);return Me}}let je=b=>{ue.event=b};ue.idxs=ee,ue._lock=!1;let ce=ue.points;ce.show=vt(ce.show),ce.size=vt(ce.size),ce.stroke=vt(ce.stroke),ce.width=vt(ce.width),ce.fill=vt(ce.fill);let Be=n.focus=Mn({},i.focus||{alpha:.3},ue.focus),Qe=Be.prox>=0,Ce=Qe&&ce.one,lt=[],qt=[],ni=[];function jo(b,T){let N=ce.show(n,T);if(N instanceof HTMLElement)return vi(N,g_),vi(N,b.class),ls(N,-10,-10,z,Re),g.insertBefore(N,lt[T]),N}function Gr(b,T){if(s==1||T>0){let N=s==1&&v[b.scale].time,F=b.value;b.value=N?Rp(F)?Fp(X,Up(F,H)):F||J:F||Ix,b.label=b.label||(N?Mx:bx)}if(Ce||T>0){b.width=b.width==null?1:b.width,b.paths=b.paths||Wx||N_,b.fillTo=vt(b.fillTo||Ux),b.pxAlign=+Et(b.pxAlign,x),b.pxRound=Xp(b.pxAlign),b.stroke=vt(b.stroke||null),b.fill=vt(b.fill||null),b._stroke=b._fill=b._paths=b._focus=null;let N=Px(ai(1,b.width),1),F=b.points=Mn({},{size:N,width:ai(1,N*.2),stroke:b.stroke,space:N*2,paths:Xx,_stroke:null,_fill:null},b.points);F.show=vt(F.show),F.filter=vt(F.filter),F.fill=vt(F.fill),F.stroke=vt(F.stroke),F.paths=vt(F.paths),F.pxAlign=b.pxAlign}if(Q){let N=Bt(b,T);Ke.splice(T,0,N[0]),Oe.splice(T,0,N[1]),fe.values.push(null)}if(me){ee.splice(T,0,null);let N=null;Ce?T==0&&(N=jo(b,T)):T>0&&(N=jo(b,T)),lt.splice(T,0,N),qt.splice(T,0,0),ni.splice(T,0,0)}Fn("addSeries",T)}function nu(b,T){T=T??y.length,b=s==1?Cu(b,T,kp,Gp):Cu(b,T,{},Hp),y.splice(T,0,b),Gr(y[T],T)}n.addSeries=nu;function cl(b){if(y.splice(b,1),Q){fe.values.splice(b,1),Oe.splice(b,1);let T=Ke.splice(b,1)[0];En(null,T.firstChild),T.remove()}me&&(ee.splice(b,1),lt.splice(b,1)[0].remove(),qt.splice(b,1),ni.splice(b,1)),Fn("delSeries",b)}n.delSeries=cl;let ts=[!1,!1,!1,!1];function _s(b,T){if(b._show=b.show,b.show){let N=b.side%2,F=v[b.scale];F==null&&(b.scale=N?y[1].scale:S,F=v[b.scale]);let W=F.time;b.size=vt(b.size),b.space=vt(b.space),b.rotate=vt(b.rotate),Xs(b.incrs)&&b.incrs.forEach(le=>{!$s.has(le)&&$s.set(le,sm(le))}),b.incrs=vt(b.incrs||(F.distr==2?nx:W?d==1?sx:ax:gr)),b.splits=vt(b.splits||(W&&F.distr==1?ae:F.distr==3?wu:F.distr==4?Ax:wx)),b.stroke=vt(b.stroke),b.grid.stroke=vt(b.grid.stroke),b.ticks.stroke=vt(b.ticks.stroke),b.border.stroke=vt(b.border.stroke);let K=b.values;b.values=Xs(K)&&!Xs(K[0])?vt(K):W?Xs(K)?Np(X,Dp(K,H)):Rp(K)?hx(X,K):K||Y:K||Sx,b.filter=vt(b.filter||(F.distr>=3&&F.log==10?Cx:F.distr==3&&F.log==2?Rx:nm)),b.font=Zp(b.font),b.labelFont=Zp(b.labelFont),b._size=b.size(n,null,T,0),b._space=b._rotate=b._incrs=b._found=b._splits=b._values=null,b._size>0&&(ts[T]=!0,b._el=Ni(f_,f))}}function xs(b,T,N,F){let[W,K,le,de]=N,Me=T%2,De=0;return Me==0&&(de||K)&&(De=T==0&&!W||T==2&&!le?Cn(Op.size/3):0),Me==1&&(W||le)&&(De=T==1&&!K||T==3&&!de?Cn(zp.size/2):0),De}let Qo=n.padding=(i.padding||[xs,xs,xs,xs]).map(b=>vt(Et(b,xs))),Bi=n._padding=Qo.map((b,T)=>b(n,T,ts,0)),ln,dn=null,pn=null,ns=s==1?y[0].idxs:null,gi=null,Bs=!1;function ea(b,T){if(e=b??[],n.data=n._data=e,s==2){ln=0;for(let N=1;N<y.length;N++)ln+=e[N][0].length}else{e.length==0&&(n.data=n._data=e=[[]]),gi=e[0],ln=gi.length;let N=e;if(k==2){N=e.slice();let F=N[0]=Array(ln);for(let W=0;W<ln;W++)F[W]=W}n._data=e=N}if(ht(!0),Fn("setData"),k==2&&(be=!0),T!==!1){let N=L;N.auto(n,Bs)?ta():Hs(S,N.min,N.max),te=te||ue.left>=0,pe=!0,qn()}}n.setData=ea;function ta(){Bs=!0;let b,T;s==1&&(ln>0?(dn=ns[0]=0,pn=ns[1]=ln-1,b=e[0][dn],T=e[0][pn],k==2?(b=dn,T=pn):b==T&&(k==3?[b,T]=bl(b,b,L.log,!1):k==4?[b,T]=Lu(b,b,L.log,!1):L.time?T=b+Cn(86400/d):[b,T]=_l(b,T,Du,!0))):(dn=ns[0]=b=null,pn=ns[1]=T=null)),Hs(S,b,T)}let Wr,zs,Xr,C,G,j,q,Z,Ee,Ie;function Te(b,T,N,F,W,K){b??=fp,N??=Uu,F??="butt",W??=fp,K??="round",b!=Wr&&(u.strokeStyle=Wr=b),W!=zs&&(u.fillStyle=zs=W),T!=Xr&&(u.lineWidth=Xr=T),K!=G&&(u.lineJoin=G=K),F!=j&&(u.lineCap=j=F),N!=C&&u.setLineDash(C=N)}function Pe(b,T,N,F){T!=zs&&(u.fillStyle=zs=T),b!=q&&(u.font=q=b),N!=Z&&(u.textAlign=Z=N),F!=Ee&&(u.textBaseline=Ee=F)}function Ve(b,T,N,F,W=0){if(F.length>0&&b.auto(n,Bs)&&(T==null||T.min==null)){let K=Et(dn,0),le=Et(pn,F.length-1),de=N.min==null?C_(F,K,le,W,b.distr==3):[N.min,N.max];b.min=Wi(b.min,N.min=de[0]),b.max=ai(b.max,N.max=de[1])}}let tt={min:null,max:null};function pt(){for(let F in v){let W=v[F];U[F]==null&&(W.min==null||U[S]!=null&&W.auto(n,Bs))&&(U[F]=tt)}for(let F in v){let W=v[F];U[F]==null&&W.from!=null&&U[W.from]!=null&&(U[F]=tt)}U[S]!=null&&ht(!0);let b={};for(let F in U){let W=U[F];if(W!=null){let K=b[F]=ro(v[F],O_);if(W.min!=null)Mn(K,W);else if(F!=S||s==2)if(ln==0&&K.from==null){let le=K.range(n,null,null,F);K.min=le[0],K.max=le[1]}else K.min=Wt,K.max=-Wt}}if(ln>0){y.forEach((F,W)=>{if(s==1){let K=F.scale,le=U[K];if(le==null)return;let de=b[K];if(W==0){let Me=de.range(n,de.min,de.max,K);de.min=Me[0],de.max=Me[1],dn=Gi(de.min,e[0]),pn=Gi(de.max,e[0]),pn-dn>1&&(e[0][dn]<de.min&&dn++,e[0][pn]>de.max&&pn--),F.min=gi[dn],F.max=gi[pn]}else F.show&&F.auto&&Ve(de,le,F,e[W],F.sorted);F.idxs[0]=dn,F.idxs[1]=pn}else if(W>0&&F.show&&F.auto){let[K,le]=F.facets,de=K.scale,Me=le.scale,[De,Ne]=e[W],ke=b[de],rt=b[Me];ke!=null&&Ve(ke,U[de],K,De,K.sorted),rt!=null&&Ve(rt,U[Me],le,Ne,le.sorted),F.min=le.min,F.max=le.max}});for(let F in b){let W=b[F],K=U[F];if(W.from==null&&(K==null||K.min==null)){let le=W.range(n,W.min==Wt?null:W.min,W.max==-Wt?null:W.max,F);W.min=le[0],W.max=le[1]}}}for(let F in b){let W=b[F];if(W.from!=null){let K=b[W.from];if(K.min==null)W.min=W.max=null;else{let le=W.range(n,K.min,K.max,F);W.min=le[0],W.max=le[1]}}}let T={},N=!1;for(let F in b){let W=b[F],K=v[F];if(K.min!=W.min||K.max!=W.max){K.min=W.min,K.max=W.max;let le=K.distr;K._min=le==3?Ss(K.min):le==4?mu(K.min,K.asinh):le==100?K.fwd(K.min):K.min,K._max=le==3?Ss(K.max):le==4?mu(K.max,K.asinh):le==100?K.fwd(K.max):K.max,T[F]=N=!0}}if(N){y.forEach((F,W)=>{s==2?W>0&&T.y&&(F._paths=null):T[F.scale]&&(F._paths=null)});for(let F in T)be=!0,Fn("setScale",F);me&&ue.left>=0&&(te=pe=!0)}for(let F in U)U[F]=null}function ze(b){let T=Su(dn-1,0,ln-1),N=Su(pn+1,0,ln-1);for(;b[T]==null&&T>0;)T--;for(;b[N]==null&&N<ln-1;)N++;return[T,N]}function mt(){if(ln>0){let b=y.some(T=>T._focus)&&Ie!=Be.alpha;b&&(u.globalAlpha=Ie=Be.alpha),y.forEach((T,N)=>{if(N>0&&T.show&&(on(N,!1),on(N,!0),T._paths==null)){let F=Ie;Ie!=T.alpha&&(u.globalAlpha=Ie=T.alpha);let W=s==2?[0,e[N][0].length-1]:ze(e[N]);T._paths=T.paths(n,N,W[0],W[1]),Ie!=F&&(u.globalAlpha=Ie=F)}}),y.forEach((T,N)=>{if(N>0&&T.show){let F=Ie;Ie!=T.alpha&&(u.globalAlpha=Ie=T.alpha),T._paths!=null&&Ut(N,!1);{let W=T._paths!=null?T._paths.gaps:null,K=T.points.show(n,N,dn,pn,W),le=T.points.filter(n,N,K,W);(K||le)&&(T.points._paths=T.points.paths(n,N,dn,pn,le),Ut(N,!0))}Ie!=F&&(u.globalAlpha=Ie=F),Fn("drawSeries",N)}}),b&&(u.globalAlpha=Ie=1)}}function on(b,T){let N=T?y[b].points:y[b];N._stroke=N.stroke(n,b),N._fill=N.fill(n,b)}function Ut(b,T){let N=T?y[b].points:y[b],{stroke:F,fill:W,clip:K,flags:le,_stroke:de=N._stroke,_fill:Me=N._fill,_width:De=N.width}=N._paths;De=Xt(De*Rt,3);let Ne=null,ke=De%2/2;T&&Me==null&&(Me=De>0?"#fff":de);let rt=N.pxAlign==1&&ke>0;if(rt&&u.translate(ke,ke),!T){let Ct=P-De/2,At=A-De/2,yt=$+De,Je=he+De;Ne=new Path2D,Ne.rect(Ct,At,yt,Je)}T?Ue(de,De,N.dash,N.cap,Me,F,W,le,K):Ft(b,de,De,N.dash,N.cap,Me,F,W,le,Ne,K),rt&&u.translate(-ke,-ke)}function Ft(b,T,N,F,W,K,le,de,Me,De,Ne){let ke=!1;Me!=0&&E.forEach((rt,Ct)=>{if(rt.series[0]==b){let At=y[rt.series[1]],yt=e[rt.series[1]],Je=(At._paths||ua).band;Xs(Je)&&(Je=rt.dir==1?Je[0]:Je[1]);let Xe,Kt=null;At.show&&Je&&I_(yt,dn,pn)?(Kt=rt.fill(n,Ct)||K,Xe=At._paths.clip):Je=null,Ue(T,N,F,W,Kt,le,de,Me,De,Ne,Xe,Je),ke=!0}}),ke||Ue(T,N,F,W,K,le,de,Me,De,Ne)}let Tn=oo|Eu;function Ue(b,T,N,F,W,K,le,de,Me,De,Ne,ke){Te(b,T,N,F,W),(Me||De||ke)&&(u.save(),Me&&u.clip(Me),De&&u.clip(De)),ke?(de&Tn)==Tn?(u.clip(ke),Ne&&u.clip(Ne),xt(W,le),_n(b,K,T)):de&Eu?(xt(W,le),u.clip(ke),_n(b,K,T)):de&oo&&(u.save(),u.clip(ke),Ne&&u.clip(Ne),xt(W,le),u.restore(),_n(b,K,T)):(xt(W,le),_n(b,K,T)),(Me||De||ke)&&u.restore()}function _n(b,T,N){N>0&&(T instanceof Map?T.forEach((F,W)=>{u.strokeStyle=Wr=W,u.stroke(F)}):T!=null&&b&&u.stroke(T))}function xt(b,T){T instanceof Map?T.forEach((N,F)=>{u.fillStyle=zs=F,u.fill(N)}):T!=null&&b&&u.fill(T)}function vs(b,T,N,F){let W=w[b],K;if(F<=0)K=[0,0];else{let le=W._space=W.space(n,b,T,N,F),de=W._incrs=W.incrs(n,b,T,N,F,le);K=Jx(T,N,de,F,le)}return W._found=K}function xn(b,T,N,F,W,K,le,de,Me,De){let Ne=le%2/2;x==1&&u.translate(Ne,Ne),Te(de,le,Me,De,de),u.beginPath();let ke,rt,Ct,At,yt=W+(F==0||F==3?-K:K);N==0?(rt=W,At=yt):(ke=W,Ct=yt);for(let Je=0;Je<b.length;Je++)T[Je]!=null&&(N==0?ke=Ct=b[Je]:rt=At=b[Je],u.moveTo(ke,rt),u.lineTo(Ct,At));u.stroke(),x==1&&u.translate(-Ne,-Ne)}function $r(b){let T=!0;return w.forEach((N,F)=>{if(!N.show)return;let W=v[N.scale];if(W.min==null){N._show&&(T=!1,N._show=!1,ht(!1));return}else N._show||(T=!1,N._show=!0,ht(!1));let K=N.side,le=K%2,{min:de,max:Me}=W,[De,Ne]=vs(F,de,Me,le==0?z:Re);if(Ne==0)return;let ke=W.distr==2,rt=N._splits=N.splits(n,F,de,Me,De,Ne,ke),Ct=W.distr==2?rt.map(Xe=>gi[Xe]):rt,At=W.distr==2?gi[rt[1]]-gi[rt[0]]:De,yt=N._values=N.values(n,N.filter(n,Ct,F,Ne,At),F,Ne,At);N._rotate=K==2?N.rotate(n,yt,F,Ne):0;let Je=N._size;N._size=Ui(N.size(n,yt,F,b)),Je!=null&&N._size!=Je&&(T=!1)}),T}function is(b){let T=!0;return Qo.forEach((N,F)=>{let W=N(n,F,ts,b);W!=Bi[F]&&(T=!1),Bi[F]=W}),T}function bs(){for(let b=0;b<w.length;b++){let T=w[b];if(!T.show||!T._show)continue;let N=T.side,F=N%2,W,K,le=T.stroke(n,b),de=N==0||N==3?-1:1,[Me,De]=T._found;if(T.label!=null){let ri=T.labelGap*de,xi=Cn((T._lpos+ri)*Rt);Pe(T.labelFont[0],le,"center",N==2?"top":up),u.save(),F==1?(W=K=0,u.translate(xi,Cn(A+he/2)),u.rotate((N==3?-gl:gl)/2)):(W=Cn(P+$/2),K=xi);let pr=em(T.label)?T.label(n,b,Me,De):T.label;u.fillText(pr,W,K),u.restore()}if(De==0)continue;let Ne=v[T.scale],ke=F==0?$:he,rt=F==0?P:A,Ct=T._splits,At=Ne.distr==2?Ct.map(ri=>gi[ri]):Ct,yt=Ne.distr==2?gi[Ct[1]]-gi[Ct[0]]:Me,Je=T.ticks,Xe=T.border,Kt=Je.show?Je.size:0,hn=Cn(Kt*Rt),On=Cn((T.alignTo==2?T._size-Kt-T.gap:T.gap)*Rt),zt=T._rotate*-gl/180,un=m(T._pos*Rt),yi=(hn+On)*de,si=un+yi;K=F==0?si:0,W=F==1?si:0;let Li=T.font[0],zi=T.align==1?eo:T.align==2?fu:zt>0?eo:zt<0?fu:F==0?"center":N==3?fu:eo,os=zt||F==1?"middle":N==2?"top":up;Pe(Li,le,zi,os);let _i=T.font[1]*T.lineGap,Di=Ct.map(ri=>m(a(ri,Ne,ke,rt))),Vi=T._values;for(let ri=0;ri<Vi.length;ri++){let xi=Vi[ri];if(xi!=null){F==0?W=Di[ri]:K=Di[ri],xi=""+xi;let pr=xi.indexOf(`
`)==-1?[xi]:xi.split(/\n/gm);for(let oi=0;oi<pr.length;oi++){let cp=pr[oi];zt?(u.save(),u.translate(W,K+oi*_i),u.rotate(zt),u.fillText(cp,0,0),u.restore()):u.fillText(cp,W,K+oi*_i)}}}Je.show&&xn(Di,Je.filter(n,At,b,De,yt),F,N,un,hn,Xt(Je.width*Rt,3),Je.stroke(n,b),Je.dash,Je.cap);let as=T.grid;as.show&&xn(Di,as.filter(n,At,b,De,yt),F,F==0?2:1,F==0?A:P,F==0?he:$,Xt(as.width*Rt,3),as.stroke(n,b),as.dash,as.cap),Xe.show&&xn([un],[1],F==0?1:0,F==0?1:2,F==1?A:P,F==1?he:$,Xt(Xe.width*Rt,3),Xe.stroke(n,b),Xe.dash,Xe.cap)}Fn("drawAxes")}function ht(b){y.forEach((T,N)=>{N>0&&(T._paths=null,b&&(s==1?(T.min=null,T.max=null):T.facets.forEach(F=>{F.min=null,F.max=null})))})}let cn=!1,ii=!1,Ot=[];function vn(){ii=!1;for(let b=0;b<Ot.length;b++)Fn(...Ot[b]);Ot.length=0}function qn(){cn||(W_(Xd),cn=!0)}function hl(b,T=!1){cn=!0,ii=T,b(n),Xd(),T&&Ot.length>0&&queueMicrotask(vn)}n.batch=hl;function Xd(){if(re&&(pt(),re=!1),be&&(Ae(),be=!1),ve){if(Jt(p,eo,Ze),Jt(p,"top",ot),Jt(p,aa,z),Jt(p,la,Re),Jt(g,eo,Ze),Jt(g,"top",ot),Jt(g,aa,z),Jt(g,la,Re),Jt(f,aa,an),Jt(f,la,yn),h.width=Cn(an*Rt),h.height=Cn(yn*Rt),w.forEach(({_el:b,_show:T,_size:N,_pos:F,side:W})=>{if(b!=null)if(T){let K=W===3||W===0?N:0,le=W%2==1;Jt(b,le?"left":"top",F-K),Jt(b,le?"width":"height",N),Jt(b,le?"top":"left",le?ot:Ze),Jt(b,le?"height":"width",le?Re:z),bu(b,yr)}else vi(b,yr)}),Wr=zs=Xr=G=j=q=Z=Ee=C=null,Ie=1,sa(!0),Ze!=we||ot!=Gt||z!=Ge||Re!=$e){ht(!1);let b=z/Ge,T=Re/$e;if(me&&!te&&ue.left>=0){ue.left*=b,ue.top*=T,qr&&ls(qr,Cn(ue.left),0,z,Re),Yr&&ls(Yr,0,Cn(ue.top),z,Re);for(let N=0;N<lt.length;N++){let F=lt[N];F!=null&&(qt[N]*=b,ni[N]*=T,ls(F,Ui(qt[N]),Ui(ni[N]),z,Re))}}if(Zt.show&&!ie&&Zt.left>=0&&Zt.width>0){Zt.left*=b,Zt.width*=b,Zt.top*=T,Zt.height*=T;for(let N in lu)Jt(Jr,N,Zt[N])}we=Ze,Gt=ot,Ge=z,$e=Re}Fn("setSize"),ve=!1}an>0&&yn>0&&(u.clearRect(0,0,h.width,h.height),Fn("drawClear"),M.forEach(b=>b()),Fn("draw")),Zt.show&&ie&&(ul(Zt),ie=!1),me&&te&&(dr(null,!0,!1),te=!1),fe.show&&fe.live&&pe&&(ou(),pe=!1),l||(l=!0,n.status=1,Fn("ready")),Bs=!1,cn=!1}n.redraw=(b,T)=>{be=T||!1,b!==!1?Hs(S,L.min,L.max):qn()};function iu(b,T){let N=v[b];if(N.from==null){if(ln==0){let F=N.range(n,T.min,T.max,b);T.min=F[0],T.max=F[1]}if(T.min>T.max){let F=T.min;T.min=T.max,T.max=F}if(ln>1&&T.min!=null&&T.max!=null&&T.max-T.min<1e-16)return;b==S&&N.distr==2&&ln>0&&(T.min=Gi(T.min,e[0]),T.max=Gi(T.max,e[0]),T.min==T.max&&T.max++),U[b]=T,re=!0,qn()}}n.setScale=iu;let su,ru,qr,Yr,$d,qd,Zr,Kr,Yd,Zd,Yt,en,Vs=!1,Hn=ue.drag,Nn=Hn.x,Un=Hn.y;me&&(ue.x&&(su=Ni(p_,g)),ue.y&&(ru=Ni(m_,g)),L.ori==0?(qr=su,Yr=ru):(qr=ru,Yr=su),Yt=ue.left,en=ue.top);let Zt=n.select=Mn({show:!0,over:!0,left:0,width:0,top:0,height:0},i.select),Jr=Zt.show?Ni(d_,Zt.over?g:p):null;function ul(b,T){if(Zt.show){for(let N in b)Zt[N]=b[N],N in lu&&Jt(Jr,N,b[N]);T!==!1&&Fn("setSelect")}}n.setSelect=ul;function qy(b){if(y[b].show)Q&&bu(Ke[b],yr);else if(Q&&vi(Ke[b],yr),me){let N=Ce?lt[0]:lt[b];N!=null&&ls(N,-10,-10,z,Re)}}function Hs(b,T,N){iu(b,{min:T,max:N})}function ss(b,T,N,F){T.focus!=null&&jy(b),T.show!=null&&y.forEach((W,K)=>{K>0&&(b==K||b==null)&&(W.show=T.show,qy(K),s==2?(Hs(W.facets[0].scale,null,null),Hs(W.facets[1].scale,null,null)):Hs(W.scale,null,null),qn())}),N!==!1&&Fn("setSeries",b,T),F&&ra("setSeries",n,b,T)}n.setSeries=ss;function Yy(b,T){Mn(E[b],T)}function Zy(b,T){b.fill=vt(b.fill||null),b.dir=Et(b.dir,-1),T=T??E.length,E.splice(T,0,b)}function Ky(b){b==null?E.length=0:E.splice(b,1)}n.addBand=Zy,n.setBand=Yy,n.delBand=Ky;function Jy(b,T){y[b].alpha=T,me&&lt[b]!=null&&(lt[b].style.opacity=T),Q&&Ke[b]&&(Ke[b].style.opacity=T)}let Ms,Gs,fr,jr={focus:!0};function jy(b){if(b!=fr){let T=b==null,N=Be.alpha!=1;y.forEach((F,W)=>{if(s==1||W>0){let K=T||W==0||W==b;F._focus=T?null:K,N&&Jy(W,K?1:Be.alpha)}}),fr=b,N&&qn()}}Q&&Qe&&St(mp,_e,b=>{ue._lock||(je(b),fr!=null&&ss(null,jr,!0,bn.setSeries))});function rs(b,T,N){let F=v[T];N&&(b=b/Rt-(F.ori==1?ot:Ze));let W=z;F.ori==1&&(W=Re,b=W-b),F.dir==-1&&(b=W-b);let K=F._min,le=F._max,de=b/W,Me=K+(le-K)*de,De=F.distr;return De==3?io(10,Me):De==4?L_(Me,F.asinh):De==100?F.bwd(Me):Me}function Qy(b,T){let N=rs(b,S,T);return Gi(N,e[0],dn,pn)}n.valToIdx=b=>Gi(b,e[0]),n.posToIdx=Qy,n.posToVal=rs,n.valToPos=(b,T,N)=>v[T].ori==0?r(b,v[T],N?$:z,N?P:0):o(b,v[T],N?he:Re,N?A:0),n.setCursor=(b,T,N)=>{Yt=b.left,en=b.top,dr(null,T,N)};function Kd(b,T){Jt(Jr,eo,Zt.left=b),Jt(Jr,aa,Zt.width=T)}function Jd(b,T){Jt(Jr,"top",Zt.top=b),Jt(Jr,la,Zt.height=T)}let na=L.ori==0?Kd:Jd,ia=L.ori==1?Kd:Jd;function e_(){if(Q&&fe.live)for(let b=s==2?1:0;b<y.length;b++){if(b==0&&at)continue;let T=fe.values[b],N=0;for(let F in T)Oe[b][N++].firstChild.nodeValue=T[F]}}function ou(b,T){if(b!=null&&(b.idxs?b.idxs.forEach((N,F)=>{ee[F]=N}):F_(b.idx)||ee.fill(b.idx),fe.idx=ee[0]),Q&&fe.live){for(let N=0;N<y.length;N++)(N>0||s==1&&!at)&&t_(N,ee[N]);e_()}pe=!1,T!==!1&&Fn("setLegend")}n.setLegend=ou;function t_(b,T){let N=y[b],F=b==0&&k==2?gi:e[b],W;at?W=N.values(n,b,T)??st:(W=N.value(n,T==null?null:F[T],b,T),W=W==null?st:{_:W}),fe.values[b]=W}function dr(b,T,N){Yd=Yt,Zd=en,[Yt,en]=ue.move(n,Yt,en),ue.left=Yt,ue.top=en,me&&(qr&&ls(qr,Cn(Yt),0,z,Re),Yr&&ls(Yr,0,Cn(en),z,Re));let F,W=dn>pn;Ms=Wt,Gs=null;let K=L.ori==0?z:Re,le=L.ori==1?z:Re;if(Yt<0||ln==0||W){F=ue.idx=null;for(let de=0;de<y.length;de++){let Me=lt[de];Me!=null&&ls(Me,-10,-10,z,Re)}Qe&&ss(null,jr,!0,b==null&&bn.setSeries),fe.live&&(ee.fill(F),pe=!0)}else{let de,Me,De;s==1&&(de=L.ori==0?Yt:en,Me=rs(de,S),F=ue.idx=Gi(Me,e[0],dn,pn),De=V(e[0][F],L,K,0));let Ne=-10,ke=-10,rt=0,Ct=0,At=!0,yt="",Je="";for(let Xe=s==2?1:0;Xe<y.length;Xe++){let Kt=y[Xe],hn=ee[Xe],On=hn==null?null:s==1?e[Xe][hn]:e[Xe][1][hn],zt=ue.dataIdx(n,Xe,F,Me),un=zt==null?null:s==1?e[Xe][zt]:e[Xe][1][zt];if(pe=pe||un!=On||zt!=hn,ee[Xe]=zt,Xe>0&&Kt.show){let yi=zt==null?-10:zt==F?De:V(s==1?e[0][zt]:e[Xe][0][zt],L,K,0),si=un==null?-10:R(un,s==1?v[Kt.scale]:v[Kt.facets[1].scale],le,0);if(Qe&&un!=null){let Li=L.ori==1?Yt:en,zi=Rn(Be.dist(n,Xe,zt,si,Li));if(zi<Ms){let os=Be.bias;if(os!=0){let _i=rs(Li,Kt.scale),Di=un>=0?1:-1,Vi=_i>=0?1:-1;Vi==Di&&(Vi==1?os==1?un>=_i:un<=_i:os==1?un<=_i:un>=_i)&&(Ms=zi,Gs=Xe)}else Ms=zi,Gs=Xe}}if(pe||Ce){let Li,zi;L.ori==0?(Li=yi,zi=si):(Li=si,zi=yi);let os,_i,Di,Vi,as,ri,xi=!0,pr=ce.bbox;if(pr!=null){xi=!1;let oi=pr(n,Xe);Di=oi.left,Vi=oi.top,os=oi.width,_i=oi.height}else Di=Li,Vi=zi,os=_i=ce.size(n,Xe);if(ri=ce.fill(n,Xe),as=ce.stroke(n,Xe),Ce)Xe==Gs&&Ms<=Be.prox&&(Ne=Di,ke=Vi,rt=os,Ct=_i,At=xi,yt=ri,Je=as);else{let oi=lt[Xe];oi!=null&&(qt[Xe]=Di,ni[Xe]=Vi,Mp(oi,os,_i,xi),vp(oi,ri,as),ls(oi,Ui(Di),Ui(Vi),z,Re))}}}}if(Ce){let Xe=Be.prox,Kt=fr==null?Ms<=Xe:Ms>Xe||Gs!=fr;if(pe||Kt){let hn=lt[0];hn!=null&&(qt[0]=Ne,ni[0]=ke,Mp(hn,rt,Ct,At),vp(hn,yt,Je),ls(hn,Ui(Ne),Ui(ke),z,Re))}}}if(Zt.show&&Vs)if(b!=null){let[de,Me]=bn.scales,[De,Ne]=bn.match,[ke,rt]=b.cursor.sync.scales,Ct=b.cursor.drag;if(Nn=Ct._x,Un=Ct._y,Nn||Un){let{left:At,top:yt,width:Je,height:Xe}=b.select,Kt=b.scales[ke].ori,hn=b.posToVal,On,zt,un,yi,si,Li=de!=null&&De(de,ke),zi=Me!=null&&Ne(Me,rt);Li&&Nn?(Kt==0?(On=At,zt=Je):(On=yt,zt=Xe),un=v[de],yi=V(hn(On,ke),un,K,0),si=V(hn(On+zt,ke),un,K,0),na(Wi(yi,si),Rn(si-yi))):na(0,K),zi&&Un?(Kt==1?(On=At,zt=Je):(On=yt,zt=Xe),un=v[Me],yi=R(hn(On,rt),un,le,0),si=R(hn(On+zt,rt),un,le,0),ia(Wi(yi,si),Rn(si-yi))):ia(0,le)}else cu()}else{let de=Rn(Yd-$d),Me=Rn(Zd-qd);if(L.ori==1){let rt=de;de=Me,Me=rt}Nn=Hn.x&&de>=Hn.dist,Un=Hn.y&&Me>=Hn.dist;let De=Hn.uni;De!=null?Nn&&Un&&(Nn=de>=De,Un=Me>=De,!Nn&&!Un&&(Me>de?Un=!0:Nn=!0)):Hn.x&&Hn.y&&(Nn||Un)&&(Nn=Un=!0);let Ne,ke;Nn&&(L.ori==0?(Ne=Zr,ke=Yt):(Ne=Kr,ke=en),na(Wi(Ne,ke),Rn(ke-Ne)),Un||ia(0,le)),Un&&(L.ori==1?(Ne=Zr,ke=Yt):(Ne=Kr,ke=en),ia(Wi(Ne,ke),Rn(ke-Ne)),Nn||na(0,K)),!Nn&&!Un&&(na(0,0),ia(0,0))}if(Hn._x=Nn,Hn._y=Un,b==null){if(N){if(lp!=null){let[de,Me]=bn.scales;bn.values[0]=de!=null?rs(L.ori==0?Yt:en,de):null,bn.values[1]=Me!=null?rs(L.ori==1?Yt:en,Me):null}ra(du,n,Yt,en,z,Re,F)}if(Qe){let de=N&&bn.setSeries,Me=Be.prox;fr==null?Ms<=Me&&ss(Gs,jr,!0,de):Ms>Me?ss(null,jr,!0,de):Gs!=fr&&ss(Gs,jr,!0,de)}}pe&&(fe.idx=F,ou()),T!==!1&&Fn("setCursor")}let Ws=null;Object.defineProperty(n,"rect",{get(){return Ws==null&&sa(!1),Ws}});function sa(b=!1){b?Ws=null:(Ws=g.getBoundingClientRect(),Fn("syncRect",Ws))}function jd(b,T,N,F,W,K,le){ue._lock||Vs&&b!=null&&b.movementX==0&&b.movementY==0||(au(b,T,N,F,W,K,le,!1,b!=null),b!=null?dr(null,!0,!0):dr(T,!0,!1))}function au(b,T,N,F,W,K,le,de,Me){if(Ws==null&&sa(!1),je(b),b!=null)N=b.clientX-Ws.left,F=b.clientY-Ws.top;else{if(N<0||F<0){Yt=-10,en=-10;return}let[De,Ne]=bn.scales,ke=T.cursor.sync,[rt,Ct]=ke.values,[At,yt]=ke.scales,[Je,Xe]=bn.match,Kt=T.axes[0].side%2==1,hn=L.ori==0?z:Re,On=L.ori==1?z:Re,zt=Kt?K:W,un=Kt?W:K,yi=Kt?F:N,si=Kt?N:F;if(At!=null?N=Je(De,At)?a(rt,v[De],hn,0):-10:N=hn*(yi/zt),yt!=null?F=Xe(Ne,yt)?a(Ct,v[Ne],On,0):-10:F=On*(si/un),L.ori==1){let Li=N;N=F,F=Li}}Me&&(T==null||T.cursor.event.type==du)&&((N<=1||N>=z-1)&&(N=mr(N,z)),(F<=1||F>=Re-1)&&(F=mr(F,Re))),de?($d=N,qd=F,[Zr,Kr]=ue.move(n,N,F)):(Yt=N,en=F)}let lu={width:0,height:0,left:0,top:0};function cu(){ul(lu,!1)}let Qd,ep,tp,np;function ip(b,T,N,F,W,K,le){Vs=!0,Nn=Un=Hn._x=Hn._y=!1,au(b,T,N,F,W,K,le,!0,!1),b!=null&&(St(pu,xu,sp,!1),ra(dp,n,Zr,Kr,z,Re,null));let{left:de,top:Me,width:De,height:Ne}=Zt;Qd=de,ep=Me,tp=De,np=Ne}function sp(b,T,N,F,W,K,le){Vs=Hn._x=Hn._y=!1,au(b,T,N,F,W,K,le,!1,!0);let{left:de,top:Me,width:De,height:Ne}=Zt,ke=De>0||Ne>0,rt=Qd!=de||ep!=Me||tp!=De||np!=Ne;if(ke&&rt&&ul(Zt),Hn.setScale&&ke&&rt){let Ct=de,At=De,yt=Me,Je=Ne;if(L.ori==1&&(Ct=Me,At=Ne,yt=de,Je=De),Nn&&Hs(S,rs(Ct,S),rs(Ct+At,S)),Un)for(let Xe in v){let Kt=v[Xe];Xe!=S&&Kt.from==null&&Kt.min!=Wt&&Hs(Xe,rs(yt+Je,Xe),rs(yt,Xe))}cu()}else ue.lock&&(ue._lock=!ue._lock,dr(T,!0,b!=null));b!=null&&(En(pu,xu),ra(pu,n,Yt,en,z,Re,null))}function n_(b,T,N,F,W,K,le){if(ue._lock)return;je(b);let de=Vs;if(Vs){let Me=!0,De=!0,Ne=10,ke,rt;L.ori==0?(ke=Nn,rt=Un):(ke=Un,rt=Nn),ke&&rt&&(Me=Yt<=Ne||Yt>=z-Ne,De=en<=Ne||en>=Re-Ne),ke&&Me&&(Yt=Yt<Zr?0:z),rt&&De&&(en=en<Kr?0:Re),dr(null,!0,!0),Vs=!1}Yt=-10,en=-10,ee.fill(null),dr(null,!0,!0),de&&(Vs=de)}function rp(b,T,N,F,W,K,le){ue._lock||(je(b),ta(),cu(),b!=null&&ra(gp,n,Yt,en,z,Re,null))}function op(){w.forEach(jx),B(n.width,n.height,!0)}_r(yl,no,op);let Qr={};Qr.mousedown=ip,Qr.mousemove=jd,Qr.mouseup=sp,Qr.dblclick=rp,Qr.setSeries=(b,T,N,F)=>{let W=bn.match[2];N=W(n,T,N),N!=-1&&ss(N,F,!0,!1)},me&&(St(dp,g,ip),St(du,g,jd),St(pp,g,b=>{je(b),sa(!1)}),St(mp,g,n_),St(gp,g,rp),Tu.add(n),n.syncRect=sa);let fl=n.hooks=i.hooks||{};function Fn(b,T,N){ii?Ot.push([b,T,N]):b in fl&&fl[b].forEach(F=>{F.call(null,n,T,N)})}(i.plugins||[]).forEach(b=>{for(let T in b.hooks)fl[T]=(fl[T]||[]).concat(b.hooks[T])});let ap=(b,T,N)=>N,bn=Mn({key:null,setSeries:!1,filters:{pub:Tp,sub:Tp},scales:[S,y[1]?y[1].scale:null],match:[Cp,Cp,ap],values:[null,null]},ue.sync);bn.match.length==2&&bn.match.push(ap),ue.sync=bn;let lp=bn.key,hu=wm(lp);function ra(b,T,N,F,W,K,le){bn.filters.pub(b,T,N,F,W,K,le)&&hu.pub(b,T,N,F,W,K,le)}hu.sub(n);function i_(b,T,N,F,W,K,le){bn.filters.sub(b,T,N,F,W,K,le)&&Qr[b](null,T,N,F,W,K,le)}n.pub=i_;function s_(){hu.unsub(n),Tu.delete(n),Dn.clear(),Mu(yl,no,op),c.remove(),_e?.remove(),Fn("destroy")}n.destroy=s_;function uu(){Fn("init",i,e),ea(e||i.data,!1),U[S]?iu(S,U[S]):ta(),ie=Zt.show&&(Zt.width>0||Zt.height>0),te=pe=!0,B(i.width,i.height)}return y.forEach(Gr),w.forEach(_s),t?t instanceof HTMLElement?(t.appendChild(c),uu()):t(n,uu):uu(),n}Gn.assign=Mn;Gn.fmtNum=Nu;Gn.rangeNum=_l;Gn.rangeLog=bl;Gn.rangeAsinh=Lu;Gn.orient=vr;Gn.pxRatio=Rt;Gn.join=G_;Gn.fmtDate=Fu,Gn.tzDate=ex;Gn.sync=wm;{Gn.addGap=Fx,Gn.clipGaps=wl;let i=Gn.paths={points:Im};i.linear=Lm,i.stepped=Bx,i.bars=zx,i.spline=Hx}var Fm=window.matchMedia("(prefers-color-scheme: dark)"),Cl=null;try{let i=localStorage.getItem("knurl theme");(i==="dark"||i==="light")&&(Cl=i)}catch{}var Om=[];function Gu(){return Cl??(Fm.matches?"dark":"light")}function Wu(){document.documentElement.dataset.theme=Gu();for(let i of Om)i()}function Xu(){Cl=Gu()==="dark"?"light":"dark";try{localStorage.setItem("knurl theme",Cl)}catch{}Wu()}function Rl(i){Om.push(i)}Fm.addEventListener("change",Wu);Wu();var Qx={background:1316636,grid:2764858,hand:15922424,arm:9081763,workspace:3752527,force:16751949,torque:13079274,contact:16769162,asleep:6055024,claims:[5941734,12028896,14722136,8368233,14843291,9413567],mine:4178341,axes:["#ff7b72","#7ee08a","#79b8ff","#e6e9ef"],text:"#aab2bf",lines:"#2a303a",warn:"#f0b429"},ev={background:16251130,grid:14278374,hand:1909547,arm:7174022,workspace:12765909,force:14245898,torque:9323693,contact:12092928,asleep:11121084,claims:[2062260,8212403,11562770,4950581,12074598,5334143],mine:888693,axes:["#d1242f","#1a7f37","#0969da","#24292f"],text:"#57606a",lines:"#e1e5eb",warn:"#b35900"};function Yn(){return Gu()==="dark"?Qx:ev}function km(i){let e=Math.min(1,Math.max(0,i)),t=[[.28,.5,.72],[.3,.75,.6],[.98,.8,.3],[.93,.27,.2]],n=Math.sqrt(e)*3,s=Math.min(2,Math.floor(n)),r=n-s;return[0,1,2].map(o=>t[s][o]+r*(t[s+1][o]-t[s][o]))}function Fe(i,e={},...t){let[n,...s]=i.split("."),r=document.createElement(n);s.length&&(r.className=s.join(" "));for(let[o,a]of Object.entries(e))typeof a=="function"?r.addEventListener(o,a):typeof a=="boolean"?r.toggleAttribute(o,a):r.setAttribute(o,String(a));return r.append(...t),r}function oe(i){let e=document.getElementById(i);if(!e)throw new Error(`the page has no element ${i}`);return e}function Mt(i,e){i.textContent!==e&&(i.textContent=e)}var ho=[],tv=200;function ut(i,e){let t=e.split(`
`)[0].slice(0,400),n=ho[0];if(n&&n.text===t&&n.level===i?(n.times++,n.at=new Date):(ho.unshift({at:new Date,level:i,text:t,times:1}),ho.length>tv&&ho.pop()),nv(),i==="quiet")return;let s=oe("toasts");for(let o of[...s.children])o.textContent===t&&o.remove();let r=Fe("div",{class:`toast ${i}`,role:i==="error"?"alert":"status"},t);for(s.append(r);s.children.length>3;)s.firstElementChild?.remove();window.setTimeout(()=>r.remove(),i==="error"?9e3:5e3)}function nv(){oe("log").replaceChildren(...ho.length?ho.map(e=>Fe("li",{class:e.level},Fe("time",{},e.at.toLocaleTimeString()),` ${e.text}${e.times>1?` (${e.times} times)`:""}`)):[Fe("li.empty",{},"Nothing has happened yet.")])}function br(i,e,t="text/plain"){let n=URL.createObjectURL(typeof e=="string"?new Blob([e],{type:t}):e),s=Fe("a",{href:n,download:i});document.body.append(s),s.click(),s.remove(),window.setTimeout(()=>URL.revokeObjectURL(n),1e4)}function uo(i,e){if(!Number.isFinite(i))return i>0?`∞ ${e}`:`${i} ${e}`;let t=Math.abs(i),[n,s]=t>=1e3?[.001,"k"]:t>=1||t===0?[1,""]:t>=.001?[1e3,"m"]:[1e6,"µ"];return`${+(i*n).toPrecision(3)} ${s}${e}`}function Bm(i,e){let t=[...i.querySelectorAll("[role=tab]")],n=s=>{for(let r of t){let o=r.getAttribute("aria-controls")===s;r.setAttribute("aria-selected",String(o)),r.tabIndex=o?0:-1,oe(r.getAttribute("aria-controls")).hidden=!o}e?.(s)};for(let[s,r]of t.entries())r.addEventListener("click",()=>n(r.getAttribute("aria-controls"))),r.addEventListener("keydown",o=>{let a=o.key==="ArrowRight"?1:o.key==="ArrowLeft"?-1:0;if(!a)return;let l=t[(s+a+t.length)%t.length];l.focus(),l.click(),o.preventDefault()});return n}var $u=(i,e)=>["x","y","z"].map(t=>({name:`${i}${t}`,label:t,factor:e})),iv=[{id:"position",title:"Position",unit:"mm",columns:$u("p",1e3),least:2,thresholds:({info:i})=>[{at:1e3*(i.centre[2]+i.radius),text:"workspace"},{at:1e3*(i.centre[2]-i.radius),text:"workspace"}]},{id:"velocity",title:"Velocity",unit:"mm/s",columns:$u("v",1e3),least:20,thresholds:()=>[{at:1500,text:"fault"},{at:-1500,text:"fault"}]},{id:"force",title:"Force",unit:"N",columns:[...$u("f",1),{name:"scene",label:"asked for",factor:1}],least:.5,thresholds:({info:i})=>[{at:i.peak_force,text:"peak"},{at:-i.peak_force,text:"peak"}]},{id:"lateness",title:"Lateness",unit:"µs",columns:[{name:"late",label:"read",factor:1},{name:"step",label:"written",factor:1}],least:50,zero:!0,thresholds:({info:i})=>[{at:5e5/i.rate,text:"half a period"},{at:1e6/i.rate,text:"period: late"}]},{id:"parts",title:"Cycle parts",unit:"µs",status:"parts",least:5,zero:!0},{id:"age",title:"Age at use",unit:"ms",status:"age",least:1,zero:!0}],qu=["#5aa9e6","#e0a458","#7fb069","#b78be0","#e27d9b","#3fc1a5","#c9b458","#8fa3bf"],Yu=class{constructor(e,t){this.spec=e;this.charts=t;this.holder=Fe("div.plot"),this.box=Fe("figure.chart",{id:`chart-${e.id}`,"aria-label":`${e.title} in ${e.unit} over time`},Fe("figcaption",{},e.title,Fe("span.unit",{},` ${e.unit}`),Fe("span.legend")),this.holder)}spec;charts;plot=null;labels="";box;holder;thresholds=[];width=0;height=0;measure(){this.width=this.holder.clientWidth,this.height=this.holder.clientHeight}reset(){this.plot?.destroy(),this.plot=null,this.labels=""}build(e,t){this.plot?.destroy();let n=Yn(),{spec:s}=this;this.box.querySelector(".legend").replaceChildren(...e.map((a,l)=>{let c=Fe("i");return c.style.background=t[l],Fe("span",{},c,a)}));let o={stroke:n.text,grid:{stroke:n.lines,width:1},ticks:{show:!1},font:"10px system-ui, sans-serif"};this.plot=new Gn({width:Math.max(80,this.width),height:Math.max(40,this.height),legend:{show:!1},padding:[6,10,0,0],cursor:{sync:{key:"knurl"},drag:{x:!0,y:!1},points:{size:5}},scales:{x:{time:!1,auto:!1,range:()=>this.charts.window().map(a=>a-this.charts.origin())},y:{range:(a,l,c)=>{if(l===null||c===null||!Number.isFinite(l)||!Number.isFinite(c))return s.zero?[0,s.least]:[-s.least/2,s.least/2];if(s.zero)return[0,Math.max(s.least,1.1*c)];let h=(l+c)/2,u=Math.max(s.least/2,.55*(c-l));return[h-u,h+u]}}},series:[{},...e.map((a,l)=>({label:a,stroke:t[l],width:a==="asked for"?.6:1.2,points:{show:!1},spanGaps:!0}))],axes:[{...o,size:18,gap:2,space:60,values:(a,l)=>l.map(c=>`${+c.toFixed(3)}`)},{...o,size:44,gap:3,space:24,values:(a,l)=>l.map(c=>`${+c.toPrecision(4)}`)}],hooks:{draw:[a=>this.mark(a)],setSelect:[a=>{if(a.select.width<4)return;let l=this.charts.origin();this.charts.zoom(l+a.posToVal(a.select.left,"x"),l+a.posToVal(a.select.left+a.select.width,"x")),a.setSelect({left:0,top:0,width:0,height:0},!1)}]}},[[],...e.map(()=>[])],this.holder),this.plot.over.addEventListener("dblclick",()=>this.charts.unzoom())}mark(e){let{ctx:t,bbox:n}=e;t.save(),t.strokeStyle=t.fillStyle=Yn().warn,t.setLineDash([4,4]),t.lineWidth=1,t.font=`${10*devicePixelRatio}px system-ui, sans-serif`,t.textAlign="left",t.textBaseline="bottom";for(let{at:r,text:o}of this.thresholds){let a=e.valToPos(r,"y",!0);a>=n.top&&a<=n.top+n.height&&(t.beginPath(),t.moveTo(n.left,a),t.lineTo(n.left+n.width,a),t.stroke(),t.fillText(o,n.left+4,a))}let s=this.charts.cursor();if(s!==null){let r=e.valToPos(s-this.charts.origin(),"x",!0);t.setLineDash([]),t.beginPath(),t.moveTo(r,n.top),t.lineTo(r,n.top+n.height),t.stroke()}t.restore()}draw(e){if(!this.width)return;let[t,n]=this.charts.window(),s=this.charts.origin(),{spec:r}=this;this.thresholds=r.thresholds?.(e)??[];let o;if(r.columns){let a=r.columns.map(h=>h.label);this.labels!==a.join()&&(this.labels=a.join(),this.build(a,r.columns.length>2?Yn().axes:qu));let l=Math.max(60,Math.min(400,Math.round(this.width/2))),c=e.history.thin(t,n,l,r.columns.map(h=>h.name));for(let[h,u]of r.columns.entries())if(u.factor!==1)for(let f=0;f<c.values[h].length;f++)c.values[h][f]*=u.factor;for(let h=0;h<c.t.length;h++)c.t[h]-=s;o=[c.t,...c.values]}else{let a=e.ages.filter(h=>h.t>=t-1&&h.t<=n+1),l=new Set;for(let h of a)for(let u of r.status==="age"?h.age.keys():Object.keys(h.parts))u!=="sleep"&&l.add(u);let c=[...l].slice(0,qu.length);(this.labels!==c.join()||!this.plot)&&(this.labels=c.join(),this.build(c,qu)),o=[a.map(h=>h.t-s),...c.map(h=>a.map(u=>r.status==="age"?u.age.get(h)===void 0?null:u.age.get(h)*1e3:u.parts[h]??null))]}(this.plot.width!==this.width||this.plot.height!==this.height)&&this.plot.setSize({width:this.width,height:this.height}),this.plot.setData(o,!0)}get canvas(){return this.plot?.ctx.canvas??null}},Il=class{constructor(e){this.model=e;this.charts=iv.map(t=>new Yu(t,this)),oe("charts").append(...this.charts.map(t=>t.box)),Rl(()=>this.charts.forEach(t=>t.reset())),oe("charts").addEventListener("wheel",t=>{t.preventDefault();let[n,s]=this.window(),r=t.deltaY>0?1.25:.8;if(this.frozen){let o=(n+s)/2,a=Math.min(600,Math.max(.005,(s-n)/2*r));this.frozen=[o-a,o+a]}else this.setSpan(Math.min(30,Math.max(.1,this.span*r)))},{passive:!1}),oe("span").addEventListener("change",t=>{this.span=Number(t.target.value),this.frozen=null,this.setPaused(!1)}),oe("pause").addEventListener("click",()=>this.setPaused(!this.paused)),oe("csv").addEventListener("click",()=>this.csv()),oe("png").addEventListener("click",()=>{this.png()}),e.on("selected",()=>this.unzoom()),e.on("recording",()=>this.unzoom())}model;charts;turn=0;span=10;paused=!1;pausedAt=0;frozen=null;setSpan(e){this.span=e;let t=oe("span");t.value=[...t.options].some(n=>Number(n.value)===e)?String(e):""}setPaused(e){if(e===this.paused&&!this.frozen)return;e&&!this.paused&&(this.pausedAt=this.model.now()),this.frozen=e?this.frozen??this.window():null,this.paused=e;let t=oe("pause");t.setAttribute("aria-pressed",String(e)),Mt(t,e?"Go on":"Pause")}zoom(e,t){this.setPaused(!0),this.frozen=[e,t]}unzoom(){this.frozen=null,this.setPaused(!1)}window(){if(this.frozen)return this.frozen;let e=this.model.now();if(this.model.recording){let{first:t,last:n}=this.model.recording.history,s=Math.min(this.span,Math.max(.01,n-t)),r=Math.min(Math.max(t,e-s/2),Math.max(t,n-s));return[r,r+s]}return[e-this.span,e]}cursor(){return this.model.recording?this.model.cursor:null}origin(){return this.model.recording?0:this.paused?this.pausedAt:this.model.now()}draw(){let e=this.model.current();e&&(this.turn=(this.turn+1)%this.charts.length,this.charts[this.turn].draw(e))}resize(){for(let t of this.charts)t.measure();let e=this.model.current();if(e)for(let t of this.charts)t.draw(e)}csv(){let e=this.model.current();if(!e?.history.held)return ut("warning","There is nothing to export yet.");let[t,n]=this.window();br(`${e.info.name}.csv`,e.history.csv(t,n),"text/csv")}async png(){let e=this.charts.map(a=>a.canvas).filter(a=>a!==null&&a.width>0);if(!e.length)return ut("warning","There is nothing to export yet.");let t=document.createElement("canvas");t.width=Math.max(...e.map(a=>a.width));let n=18*devicePixelRatio;t.height=e.reduce((a,l)=>a+l.height+n,0);let s=t.getContext("2d");s.fillStyle=getComputedStyle(document.body).backgroundColor,s.fillRect(0,0,t.width,t.height);let r=0;this.charts.forEach(a=>{a.canvas?.width&&(s.fillStyle=Yn().text,s.font=`${12*devicePixelRatio}px system-ui, sans-serif`,s.fillText(`${a.spec.title} [${a.spec.unit}]`,4,r+.75*n),s.drawImage(a.canvas,0,r+n),r+=a.canvas.height+n)});let o=await new Promise(a=>t.toBlob(a,"image/png"));o&&br(`${this.model.current()?.info.name??"knurl"}.png`,o)}};var Pl=class{exchanges=[];ages=new Float32Array(600);count=0;last=0;take(e,t,n){this.exchanges.push({offset:n-(e+t)/2,took:t-e}),this.exchanges.length>16&&this.exchanges.shift()}get best(){return this.exchanges.reduce((e,t)=>e&&e.took<=t.took?e:t,void 0)}drawn(e,t){let n=this.best;!n||e===this.last||(this.last=e,this.ages[this.count++%this.ages.length]=t+n.offset-e)}get age(){let e=Math.min(this.count,this.ages.length),t=this.ages.slice(0,e).sort(),n=s=>e===0?0:1e3*t[Math.min(e-1,Math.floor(s*e))];return{p50:n(.5),p99:n(.99),within:500*(this.best?.took??0)}}};var da={touching:1,clamped:2,infeasible:4,fading:8,silent:16,asleep:32},sv=["disconnected","idle","armed","ramp up","active","ramp down","fault"];function zm(i){return typeof i=="number"?sv[i]??`state ${i}`:i.replaceAll("_"," ")}var rv=14;function Vm(i){if(i.byteLength<24)throw new Error(`a binary message of ${i.byteLength} bytes, shorter than its head`);let e=new DataView(i),t=e.getUint32(0,!0);if(t!==1)throw new Error(`a binary message of kind ${t}, which this page does not know`);let n=e.getUint32(8,!0);if(i.byteLength!==24+n*rv*4)throw new Error(`a binary message says ${n} reports and has ${i.byteLength-24} bytes for them`);return{device:e.getUint32(4,!0),count:n,t:e.getFloat64(16,!0),data:new Float32Array(i,24)}}function Tt(i,e=0){return typeof i=="number"?i:i==="inf"?1/0:i==="-inf"?-1/0:e}function Ll(i,e=[0,0,0]){return Array.isArray(i)&&i.length>=3?[Tt(i[0]),Tt(i[1]),Tt(i[2])]:e}function Hm(i){if(i.byteLength<8)throw new Error("a mesh that is shorter than its head");let e=new DataView(i),t=e.getUint32(0,!0),n=e.getUint32(4,!0);if(i.byteLength!==8+12*t+12*n)throw new Error(`a mesh says ${t} vertices and ${n} triangles and has ${i.byteLength} bytes`);let s=new Uint32Array(i,8+12*t,3*n);for(let r of s)if(r>=t)throw new Error(`a mesh names vertex ${r} of ${t}`);return{positions:new Float32Array(i,8,3*t),indices:s}}var ov=8,Gm=10,Dl=class{constructor(e,t){this.url=e;this.handlers=t}url;handlers;socket=null;pending=new Map;next=1;attempts=0;timer=0;stopped=!1;reconnects=0;messages=0;work=0;opened=!1;open(){window.clearTimeout(this.timer);let e=new WebSocket(this.url,"knurl.live.v1");e.binaryType="arraybuffer",this.socket=e,e.onopen=()=>{this.opened&&this.reconnects++,this.opened=!0,this.attempts=0,this.handlers.link("open","",0)},e.onmessage=t=>{let n=performance.now();this.messages++;try{typeof t.data=="string"?this.text(t.data):this.handlers.reports(Vm(t.data))}catch(s){this.handlers.strange(s instanceof Error?s.message:String(s))}this.work+=performance.now()-n},e.onclose=t=>{if(this.socket===e){this.socket=null;for(let[,n]of this.pending)window.clearTimeout(n.timer),n.reject(new Error("the connection was lost before the answer came"));this.pending.clear(),this.stopped||this.lost(t.reason)}}}text(e){let t;try{t=JSON.parse(e)}catch{throw new Error(`a message that is no JSON: ${e.slice(0,60)}`)}if(t===null||typeof t!="object"||typeof t.op!="string")throw new Error(`a message without op: ${e.slice(0,60)}`);if(t.op==="answer"){let n=this.pending.get(t.id);if(!n)return;this.pending.delete(t.id),window.clearTimeout(n.timer),t.ok?n.resolve(t):n.reject(new Error(t.error??"refused without a reason"));return}this.handlers.message(t)}async lost(e){this.attempts++;let t=Math.min(ov,.5*2**(this.attempts-1));this.handlers.link("lost",e||"the connection to knurl-web was lost",t);try{let n=await fetch("./",{cache:"no-store"});if(n.status===401||n.status===403){this.handlers.link("gone","knurl-web no longer knows this page (it was started anew, or its token changed)",0);return}}catch{}this.timer=window.setTimeout(()=>this.open(),t*1e3)}get connected(){return this.socket?.readyState===WebSocket.OPEN}request(e,t={}){let n=this.socket;if(!n||n.readyState!==WebSocket.OPEN)return Promise.reject(new Error("not connected to knurl-web"));let s=this.next++;return new Promise((r,o)=>{let a=window.setTimeout(()=>{this.pending.delete(s),o(new Error(`${e}: no answer within ${e==="doctor"?120:Gm} s`))},(e==="doctor"?120:Gm)*1e3);this.pending.set(s,{resolve:r,reject:o,timer:a}),n.send(JSON.stringify({op:e,id:s,...t}))})}close(){this.stopped=!0,this.socket?.close()}};var pa=["px","py","pz","vx","vy","vz","fx","fy","fz","late","step","scene","state"],fo=class{constructor(e){this.capacity=e;this.t=new Float64Array(e),this.columns=Object.fromEntries(pa.map(t=>[t,new Float32Array(e)]))}capacity;t;columns;count=0;get held(){return Math.min(this.count,this.capacity)}get last(){return this.count===0?0:this.t[(this.count-1)%this.capacity]}get first(){return this.count===0?0:this.t[(this.count-this.held)%this.capacity]}clear(){this.count=0}push(e,t,n=0){this.count>0&&e<this.last&&this.clear();let s=this.count%this.capacity;this.t[s]=e;for(let r=0;r<pa.length;r++)this.columns[pa[r]][s]=t[n+r];this.count++}place(e){return(this.count-this.held+e)%this.capacity}find(e){let t=0,n=this.held;for(;t<n;){let s=t+n>>1;this.t[this.place(s)]<e?t=s+1:n=s}return t}thin(e,t,n,s){let r=Math.max(0,this.find(e)-1),o=Math.min(this.held,this.find(t)+1),a=o-r,l=[],c=s.map(()=>[]);if(a<=0)return{t:l,values:c};let h=s.map(g=>this.columns[g]);if(a<=2*n){for(let g=r;g<o;g++){let x=this.place(g);l.push(this.t[x]);for(let m=0;m<h.length;m++)c[m].push(h[m][x])}return{t:l,values:c}}let u=Math.ceil(a/n),f=this.count-this.held+r,p=f-f%u;for(let g=Math.max(p,this.count-this.held);g<this.count-this.held+o;g+=u){let x=Math.min(g+u,this.count-this.held+o),m=this.t[g%this.capacity],d=this.t[(x-1)%this.capacity];l.push(m,d>m?(m+d)/2:m+1e-9);for(let y=0;y<h.length;y++){let w=1/0,v=-1/0,E=0,S=0;for(let _=g;_<x;_++){let M=h[y][_%this.capacity];M<w&&(w=M,E=_),M>v&&(v=M,S=_)}E<=S?c[y].push(w,v):c[y].push(v,w)}}return{t:l,values:c}}csv(e,t){let n=["m","m","m","m/s","m/s","m/s","N","N","N","us","us","N",""],s=["t [s],"+pa.map((r,o)=>n[o]?`${r} [${n[o]}]`:r).join(",")];for(let r=this.find(e);r<this.held;r++){let o=this.place(r);if(this.t[o]>t)break;s.push([this.t[o].toFixed(6),...pa.map(a=>+this.columns[a][o].toPrecision(7))].join(","))}return s.join(`
`)+`
`}};var ma=class{constructor(e,t){this.info=e;let n=16384;for(;n<32*e.rate&&n<1<<18;)n<<=1;this.history=new fo(t??n)}info;history;frame=null;unseen=0;status=null;claims=new Map;items=new Map;felt=[];version=0;ages=[];get state(){return this.frame?zm(this.frame.state):"disconnected"}mine(){for(let e of this.claims.values())if(e.mine)return e}kMax(){let e=this.info.max_stiffness;return typeof e=="number"&&e>0?e:1/0}};function po(i,e){return`${i}:${e}`}var Nl=class{hello=null;servo=null;devices=new Map;kinds=new Map;recording=null;recordedMeshes=new Map;cursor=0;selected=0;asset=()=>{};forgetting=()=>{};note=()=>{};listeners=new Map;on(e,t){let n=this.listeners.get(e)??[];n.push(t),this.listeners.set(e,n)}tell(e){for(let t of this.listeners.get(e)??[])t()}shown(){return this.recording?[this.recording]:[...this.devices.values()]}current(){return this.recording??this.devices.get(this.selected)??this.devices.values().next().value}now(){let e=this.current();return e?e===this.recording?this.cursor:e.history.last:0}can(e){let t=this.hello?.role;return t==="control"||t===e}forget(){this.forgetting();for(let e of this.devices.values())(e.claims.size||e.items.size)&&e.version++,e.claims.clear(),e.items.clear(),e.felt=[];this.tell("scene")}take(e){switch(e.op){case"hello":this.hello=e,this.kinds=new Map(e.kinds.map(t=>[t.name,t])),this.tell("hello");break;case"servo":this.takeServo(e);break;case"frame":for(let t of e.devices){let n=this.devices.get(t.i);n&&(n.frame=t,n.unseen+=t.gap??0)}break;case"scene":{let t=this.devices.get(e.device);t&&this.takeScene(t,e,performance.now());break}case"felt":{let t=this.devices.get(e.device);t&&this.takeFelt(t,e.items);break}case"status":for(let t of e.devices){let n=this.devices.get(t.i);if(!n)continue;n.status=t;let s=new Map;for(let r of t.clients)!r.observer&&r.age!==null&&r.age>0&&s.set(`${r.name} ${r.pid}`,r.age);n.ages.push({t:n.history.last,age:s,parts:t.parts}),n.ages.length>400&&n.ages.shift()}this.tell("status");break;case"asset":this.asset(e);break;case"note":this.note(e.level,e.text);break;case"answer":break;default:throw new Error(`a message "${e.op}", which this page does not know`)}}takeScene(e,t,n){t.full&&(e.claims.clear(),e.items.clear(),e.felt=[]);for(let s of t.gone??[])if(s.length>1)e.items.delete(po(s[0],s[1]));else{e.claims.delete(s[0]);for(let[r,o]of e.items)o.claim===s[0]&&e.items.delete(r)}for(let s of t.claims??[])e.claims.set(s.claim,s);for(let s of t.items??[]){let r=po(s.claim,s.slot),o=e.items.get(r),a=o&&o.generation===s.generation&&o.kind===s.kind;e.items.set(r,{...s,version:(o?.version??0)+1,since:n,felt:a?o.felt:null})}e.felt=e.felt.filter(s=>e.items.get(po(s.claim,s.slot))===s),e.version++,this.tell("scene")}takeFelt(e,t){for(let n of e.items.values())n.felt=null;e.felt=[];for(let n of t){let s=e.items.get(po(n[0],n[1]));s&&(s.felt=n,e.felt.push(s))}}takeServo(e){let t=this.servo&&this.servo.pid!==e.pid&&e.pid!==0&&this.servo.pid!==0;if(this.servo=e,e.connected||e.devices.length>0){let n=new Set(e.devices.map(s=>s.i));for(let s of[...this.devices.keys()])n.has(s)||this.devices.delete(s);for(let s of e.devices){let r=this.devices.get(s.i);!r||r.info.name!==s.name||r.info.rate!==s.rate?this.devices.set(s.i,new ma(s)):r.info=s}}if(t)for(let n of this.devices.values())n.history.clear();if(!e.connected){for(let n of this.devices.values())n.frame=null,n.status=null;this.forget()}!this.devices.has(this.selected)&&this.devices.size&&(this.selected=this.devices.keys().next().value??0),this.tell("servo")}takeReports(e){let t=this.devices.get(e.device);if(!t)return;let{data:n,t:s}=e;for(let r=0;r<e.count;r++)t.history.push(s+n[r*14],n,r*14+1)}itemsOf(e,t){return[...e.items.values()].filter(n=>n.claim===t).sort((n,s)=>n.slot-s.slot)}};function Wm(i,e){let t=i.felt?.[2]??0;return t&da.asleep?"asleep":t&(da.fading|da.silent)||e?"faded":t&da.touching?"touched":"there"}function Ul(i,e){let t=i.history,n=t.place(Math.max(0,Math.min(t.held-1,e))),s=t.columns;return{i:i.info.i,cycle:e,t:t.t[n],state:s.state[n],faults:[],p:[s.px[n],s.py[n],s.pz[n]],q:[1,0,0,0],v:[s.vx[n],s.vy[n],s.vz[n]],w:[0,0,0],scene_force:[0,0,0],force:[s.fx[n],s.fy[n],s.fz[n]],torque:[0,0,0],contact:[s.px[n],s.py[n],s.pz[n]],buttons:0,flags:[],late:0,arm:[],gap:0}}var av=[{name:"not finite",cause:"A scene computed a value that is not a number.",remedy:"Report it: the servo should have refused the parameter."},{name:"slew",cause:"The force changed by more than 2000 N/s for 5 ms: an unstable loop.",remedy:"Lower the stiffness or add damping; see what buzzes. Then reset."},{name:"speed",cause:"The hand was faster than 1.5 m/s: the device was thrown, or the loop is unstable.",remedy:"Hold the device still; lower the stiffness if it ran away by itself. Then reset."},{name:"power",cause:"More than 5 W went into the hand over 50 ms: an unstable loop, often a coupling without an energy account.",remedy:"Use a coupling with an energy account, or less stiffness. Then reset."},{name:"unplugged",cause:"The device is gone.",remedy:"Check cable and power. It comes back by itself, then reset."},{name:"bad samples",cause:"Ten unusable samples came in a row.",remedy:"Check cable, hub, interference; run knurl device test. Then reset."},{name:"encoder jump",cause:"The position jumped by more than a hand can.",remedy:"Calibrate (home) the device; check its cable. Then reset."},{name:"clock jump",cause:"The machine was suspended, or the servo stopped for more than a second.",remedy:"Reset."},{name:"kinematics",cause:"The mechanism has no pose for the joints.",remedy:"Check the arm's file; home the device. Then reset."},{name:"guardian",cause:"The servo made no cycle for 20 ms with force on, and the guardian put the motors to zero.",remedy:"Look for late cycles: knurl doctor, knurl trace --around late. Then reset."},{name:"overload",cause:"Cycles took longer than the period for 20 ms: too many representations at the hand, or a busy machine without real-time rights.",remedy:"Remove representations, or run the servo at a lower rate. Then reset."},{name:"unguarded",cause:"The process knurl-guardian did not run for 40 ms (250 ms without real-time rights).",remedy:"Let it go on if somebody stopped it (kill -CONT); give it real-time rights. Then reset."}],lv=["not finite","slew","speed","power","unplugged","bad samples","encoder jump","clock jump","kinematics","guardian","overload","unguarded"];function Zu(i){let e=i.replaceAll("_"," ");return av.find(t=>t.name===e)??{name:e,cause:"A fault that this page does not know.",remedy:"See docs/howto/troubleshooting.md of the servo's version."}}function Xm(i){return lv.filter((e,t)=>i&1<<t)}function cv(i,e){let t=i.length;for(let n=1,s=0;n<t;n++){let r=t>>1;for(;s&r;r>>=1)s^=r;s^=r,n<s&&([i[n],i[s]]=[i[s],i[n]],[e[n],e[s]]=[e[s],e[n]])}for(let n=2;n<=t;n<<=1){let s=-2*Math.PI/n,r=Math.cos(s),o=Math.sin(s);for(let a=0;a<t;a+=n){let l=1,c=0;for(let h=0;h<n/2;h++){let u=a+h,f=u+n/2,p=i[f]*l-e[f]*c,g=i[f]*c+e[f]*l;i[f]=i[u]-p,e[f]=e[u]-g,i[u]+=p,e[u]+=g,[l,c]=[l*r-c*o,l*o+c*r]}}}}var hv=15,uv=.03,fv=2e-5;function dv(i,e){let t=i[0].length,n=new Float64Array(t/2);for(let d of i){let y=0;for(let E of d)y+=E/t;let w=new Float64Array(t),v=new Float64Array(t);for(let E=0;E<t;E++)w[E]=(d[E]-y)*(.5-.5*Math.cos(2*Math.PI*E/t));cv(w,v);for(let E=0;E<t/2;E++)n[E]+=w[E]*w[E]+v[E]*v[E]}let s=e/t,r=Math.ceil(hv/s),o=r,a=0,l=0;for(let d=1;d<t/2;d++)d<r?l+=n[d]:(a+=n[d],n[d]/(d*d)>n[o]/(o*o)&&(o=d));let c=0,h=0;for(let d=Math.max(r-2,o-3);d<=Math.min(t/2-1,o+3);d++)c+=n[d],h+=n[d]*d;let u=c>0?h/c*s:0,f=t*t*3/8,p=2*Math.sqrt(c/f),g=u>0?p/(2*Math.PI*u):0,x=Math.sqrt(2*l/f),m=a>0?Math.min(1,c/a):0;return{frequency:u,amplitude:g,slow:x,share:m,buzzes:g>fv&&x<uv&&m>.3}}var ga=1.024,Fl=1024;function $m(i,e=i.last){let t=e-ga,n=i.find(t),s=Math.min(i.held-1,i.find(e));if(i.held<256||i.t[i.place(0)]>t||s-n<128)return null;let r=[i.columns.vx,i.columns.vy,i.columns.vz].map(o=>{let a=new Float64Array(Fl),l=n;for(let c=0;c<Fl;c++){let h=t+ga*c/Fl;for(;l<s&&i.t[i.place(l+1)]<=h;)l++;let u=i.place(l),f=i.place(Math.min(l+1,s)),p=i.t[f]-i.t[u],g=p>0?Math.min(1,Math.max(0,(h-i.t[u])/p)):0;a[c]=o[u]+g*(o[f]-o[u])}return a});return dv(r,Fl/ga)}function qm(i,e,t=i.last){let{px:n,py:s,pz:r,fx:o,fy:a,fz:l}=i.columns,c=0,h=-1;for(let u=i.find(t-e);u<i.held;u++){let f=i.place(u);if(i.t[f]>t)break;h>=0&&i.t[f]-i.t[h]<.05&&(c+=o[h]*(n[f]-n[h])+a[h]*(s[f]-s[h])+l[h]*(r[f]-r[h])),h=f}return c}function Ym(i,e){if(!i||!i.buzzes)return"";let t=`${(i.amplitude*1e3).toFixed(2)} mm at ${i.frequency.toFixed(0)} Hz`,n=e.vibrations.find(r=>Math.abs(r-i.frequency)<Math.max(3,.05*r));if(!e.forced)return`The hand shakes: ${t}, and no force of the device is on: a table that shakes, or a noisy encoder, usually causes this.`;if(n!==void 0)return`The hand vibrates: ${t}, as a vibration of ${n} Hz asks for.`;let s=Number.isFinite(e.kMax)?` (${Math.round(e.kMax)} N/m)`:"";return e.stiffest>e.kMax?`The hand buzzes: ${t}. What it touches asks for ${Math.round(e.stiffest)} N/m, more than the device's k_max${s}; lower the stiffness or add damping of 1 to 3 N s/m.`:e.late>0?`The hand buzzes: ${t}. The servo had ${e.late} late cycles meanwhile, which usually cause this: run knurl doctor; until then lower the stiffness.`:e.textured&&i.frequency>60?`The hand buzzes: ${t}. A texture finer than the encoder usually causes this; give it a longer wavelength, or less amplitude.`:`The hand buzzes: ${t}. A stiffness above the device's k_max${s}, a late servo, or too little damping usually cause this; lower the stiffness or add damping of 1 to 3 N s/m.`}function Zm(i,e){if(i<.02)return"";let t=`In 10 s the device gave the hand ${(i*1e3).toFixed(0)} mJ.`;return e.length?`${t} ${e.join(", ")} may do so; surfaces alone never give more than they took.`:`${t} Surfaces take energy or return it; what gives goes on its own: a moving surface, forces from the application's loop, or a wall that is too stiff.`}var pv=["spring","constant_force","taylor","taylor6","gravity","magnet","constraint","vibration"],Ol=class{constructor(e,t){this.model=e;this.connection=t;for(let n of["arm","disarm","reset"])oe(n).addEventListener("click",()=>{this.ask(n)});oe("record").addEventListener("click",()=>{this.record()}),oe("doctor").addEventListener("click",()=>{this.doctor(!1)}),oe("doctor-run").addEventListener("click",()=>{this.doctor(!0)}),e.on("hello",()=>this.roles()),e.on("servo",()=>this.servo()),e.on("selected",()=>{this.servo(),this.recordings()}),e.on("recording",()=>this.roles()),e.on("status",()=>{this.clients(),this.recordings()})}model;connection;lateBefore=new Map;faultsShown="?";recordingSince=new Map;async ask(e){let t=this.model.current();if(!t)return ut("warning","There is no device.");try{await this.connection().request(e,{device:t.info.i})}catch(n){ut("error",n.message)}}async record(){let e=this.model.current();if(!e)return ut("warning","There is no device.");let t=!!e.status?.recording,n=oe("record-name").value.trim()||"knurl.mcap";try{let s=await this.connection().request(t?"stop":"record",{device:e.info.i,file:n});Mt(oe("record-path"),`${t?"Recorded":"Recording"}: ${String(s.path??n)}`),e.status&&(e.status.recording=t?null:String(s.path??n)),this.recordings()}catch(s){ut("error",s.message)}}recordings(){for(let{info:n,status:s}of this.model.devices.values())s?.recording?this.recordingSince.has(n.i)||this.recordingSince.set(n.i,performance.now()):this.recordingSince.delete(n.i);let e=this.model.current(),t=e&&this.recordingSince.get(e.info.i);if(oe("record").classList.toggle("on",t!==void 0),t===void 0)return Mt(oe("record"),"Record");Mt(oe("record"),`Stop (${((performance.now()-t)/1e3).toFixed(0)} s)`),Mt(oe("record-path"),`Recording: ${e?.status?.recording}`)}async doctor(e){let t=oe("doctor-verdict");Mt(t,e?"knurl doctor runs; this takes up to a minute ...":"...");try{let n=await this.connection().request("doctor",e?{run:!0}:{}),s=n.verdict??n.doctor??n.result??n;if(!s.rates){Mt(t,"knurl doctor has not run here yet.");return}t.replaceChildren(Fe("p",{},s.machine?.date?`Of ${s.machine.date}:`:""),Fe("ul.grades",{},...s.rates.map(r=>Fe("li",{class:r.fitness,title:r.reason},`${r.rate} Hz: ${r.fitness}`))),Fe("ul.findings",{},...(s.findings??[]).filter(r=>r.grade!=="good").map(r=>Fe("li",{class:r.grade},`${r.what}: ${r.says}`,...r.mend?[Fe("code",{},r.mend)]:[]))))}catch(n){Mt(t,""),ut("error",n.message)}}roles(){let e=this.model.hello,t=this.model.can("control")&&!this.model.recording;for(let n of["arm","disarm","reset","record","record-name","doctor-run"])oe(n).disabled=!t;Mt(oe("role"),e?{observe:"looks on",render:"may add",control:"controls"}[e.role]:""),oe("role").title="what this page may do: observe, render or control",oe("record-box").hidden=!e?.recordings,oe("control-why").hidden=this.model.can("control")||!e,this.clients()}servo(){let e=this.model.servo,t=oe("servo");Mt(t,e?e.connected?`${e.name} · pid ${e.pid}`:e.trouble||"no servo":""),t.classList.toggle("bad",!!e&&!e.connected);let n=oe("devices"),s=[...this.model.devices.values()],r=this.model.current();n.replaceChildren(...s.length>1?s.map(a=>Fe("button.small",{type:"button","aria-pressed":String(a===r),click:()=>(this.model.selected=a.info.i,this.model.tell("selected"))},a.info.name)):[]);let o=r?.info;oe("device-facts").replaceChildren(...o?[["device",`${o.name} (${o.address})`],["profile",[o.profile,o.serial].filter(Boolean).join(", ")],["rate",`${o.rate} Hz`],["workspace",`ball of ${uo(o.radius,"m")}`],["peak force",uo(o.peak_force,"N")],["k_max",Number.isFinite(r.kMax())?`${Math.round(r.kMax())} N/m`:"not known"],["lag",o.lag?uo(o.lag,"s"):""]].filter(([,a])=>a).flatMap(([a,l])=>[Fe("dt",{},a),Fe("dd",{},l)]):[Fe("dt",{},"no device"),Fe("dd",{},"")])}slow(){let e=this.model.current(),t=e?this.model.recording?"recording":e.state:"no device",n=oe("state");Mt(n,t),n.dataset.state=t;let s=e?.frame,r=s?Math.hypot(...s.force):0;Mt(oe("readout"),s?`${s.p.map(a=>(1e3*a).toFixed(1).padStart(6)).join(" ")} mm   ${r.toFixed(2)} N`:"");let o=(s?.flags??[]).filter(a=>a!=="touching").map(a=>({clamped:"force limited by the supervisor",stale:"no new sample",guardian:"the guardian had zeroed the motors","near singular":"the arm is near a singular posture",near_singular:"the arm is near a singular posture","at joint limit":"a joint is at its stop",at_joint_limit:"a joint is at its stop"})[a]??a);Mt(oe("flags"),o.join(" · ")),this.faults(e),this.indicators(e),this.recordings()}faults(e){let t=e?.frame?.faults??[],n=t.join();if(n===this.faultsShown)return;let s=this.faultsShown;this.faultsShown=n;let r=oe("faults");r.hidden=t.length===0,oe("reset").classList.toggle("primary",t.length>0),oe("arm").classList.toggle("primary",t.length===0),r.replaceChildren(...t.map(o=>{let a=Zu(o);return Fe("div.fault",{"data-fault":a.name},Fe("strong",{},`Fault: ${a.name}`),Fe("p",{},a.cause),Fe("p.remedy",{},a.remedy))})),t.length&&n!==s&&ut("error",`${e?.info.name}: fault ${t.join(", ").replaceAll("_"," ")}: ${Zu(t[0]).cause}`)}situation(e){let t=e.felt.filter(r=>(r.felt?.[2]??0)&1),n=this.lateBefore.get(e)??[],s=performance.now();for(n.push({at:s,count:e.frame?.late??0});n.length>1&&s-n[0].at>2e3;)n.shift();return this.lateBefore.set(e,n),{kMax:e.kMax(),stiffest:Math.max(0,...t.map(r=>{let o=Tt(r.params.stiffness);return Number.isFinite(o)?o/(e.claims.get(r.claim)?.frame.scale||1):0})),late:Math.max(0,n[n.length-1].count-n[0].count),forced:this.forced(e),vibrations:[...e.items.values()].filter(r=>r.kind==="vibration"&&Tt(r.params.amplitude)>0).map(r=>Tt(r.params.frequency,100)),textured:t.some(r=>Tt(r.params["texture.amplitude"])>0||Tt(r.params["snag.k_stick"])>0)}}forced(e){let{fx:t,fy:n,fz:s}=e.history.columns,r=this.model.now();for(let o=e.history.find(r-ga);o<e.history.held;o+=16){let a=e.history.place(o);if(e.history.t[a]>r)break;if(Math.hypot(t[a],n[a],s[a])>.02)return!0}return!1}indicators(e){let t=e?.history.held??0,n=this.model.now(),s=e&&t?$m(e.history,n):null,r=e&&t?qm(e.history,10,n):0;Mt(oe("buzz"),s?s.slow>.03&&!s.buzzes?"moves":s.buzzes?`${(s.amplitude*1e3).toFixed(2)} mm at ${s.frequency.toFixed(0)} Hz`:"quiet":"–"),oe("buzz").classList.toggle("bad",!!s?.buzzes),Mt(oe("energy"),t?`${r*1e3>0?"+":""}${(r*1e3).toFixed(1)} mJ`:"–");let o=e?[...new Set([...e.items.values()].filter(l=>pv.includes(l.kind)).map(l=>l.kind.replaceAll("_"," ")))]:[],a=e&&t?[Ym(s,this.situation(e)),Zm(r,o)].filter(Boolean):[];Mt(oe("advice"),a.join(" ")),oe("advice").hidden=a.length===0,oe("advice-over").hidden=!s?.buzzes,Mt(oe("advice-over"),s?.buzzes?a[0]:"")}clients(){let e=this.model.current(),t=e?.status,n=oe("servo-facts"),s=t?Object.entries(t.parts).map(([r,o])=>`${r} ${o<100?o.toFixed(2):o.toFixed(0)}`).join("  "):"";Mt(n,t?`${t.rate.toFixed(1)} of ${e.info.rate} Hz · busy ${(100*t.busy).toFixed(2)} % · cycle ${t.step.toFixed(1)} µs
lateness median ${t.late_median.toFixed(1)} µs, at most ${t.late_max.toFixed(1)} µs · ${t.late} late cycles · ${t.overruns} overruns${e.unseen?` · ${e.unseen} reports not seen here`:""}
cycle µs: ${s}`:"No servo is connected."),n.classList.toggle("bad",!!t&&t.rate<.98*e.info.rate),oe("clients").replaceChildren(...(t?.clients??[]).map(r=>{let o=Object.entries(r.representations??{}).map(([c,h])=>`${h} ${c.replaceAll("_"," ")}`).join(", "),a=r.scales?Object.entries(r.scales).filter(([,c])=>c<.995).map(([c,h])=>`${c} ×${h.toFixed(2)}`):[],l=[r.silent?"silent":"",r.shed?"shed":"",r.armed?"armed":""].filter(Boolean);return Fe("tr",{class:r.silent||r.shed?"bad":""},Fe("td",{},Fe("b",{},r.name||"unnamed"),Fe("small",{},` ${r.pid} ${l.join(" ")}`)),...r.observer?[Fe("td",{colspan:4},"observes"),Fe("td",{},String(r.missed))]:[Fe("td",{},r.rate.toFixed(1)),Fe("td",{},r.age?`${(r.age*1e3).toFixed(2)}`:"–"),Fe("td",{title:`commits ${r.commits}, merged ${r.merged}, refused ${r.refused}`},`${r.merged}/${r.refused}`),Fe("td",{},r.gain.toFixed(2)),Fe("td",{},String(r.missed))],...r.observer?[]:[Fe("td.what",{},o||"nothing",...a.length?[Fe("small.warn",{},` ${a.join(" ")}`)]:[])])}))}};function Si(i){let e=String(+i.toPrecision(9));return e==="-0"?"0":e}function mv(i){return/[.e]/.test(i)?i:`${i}.0`}function gv(i,e){if(i===void 0)return!1;let t=r=>Array.isArray(r)?r.flat():[r],n=t(i),s=t(e);return n.length!==s.length||n.some((r,o)=>typeof r=="number"&&typeof s[o]=="number"?Math.abs(r-s[o])>1e-12*Math.max(1,Math.abs(r)):r!==s[o])}function Ju(i){let e=new Map;return i.map(({kind:t})=>{let n=(e.get(t)??0)+1;return e.set(t,n),n===1?t:`${t}_${n}`})}function ju(i,e){return(i?.fields??[]).filter(t=>gv(e[t.name],t.default)).map(t=>[t,e[t.name]])}function Qu(i,e){let t=e.flat(),n=i.count===36||t.length===36?6:3;return Array.from({length:n},(s,r)=>t.slice(r*n,r*n+n))}function yv(i,e){let t=n=>`[${n.map(Si).join(", ")}]`;return typeof e=="string"?e==="inf"||e==="-inf"?e:JSON.stringify(e):typeof e=="number"?Si(e):i.type==="matrix"?`[${Qu(i,e).map(t).join(", ")}]`:i.type==="points"?`[${e.map(t).join(", ")}]`:t(e)}function Jm(i){let e=["# A scene of Knurl, for `knurl eval --scene` and `knurl replay --scene`. Lengths in m, forces in N.",""],t=[...i.probes].sort((o,a)=>o[0]-a[0]),n=Math.max(-1,...t.map(([o])=>o));for(let o=0;o<=n;o++){let a=t.find(([l])=>l===o);e.push("[[probe]]",`offset = [${(a?.[1]??[0,0,0]).map(Si).join(", ")}]`,`radius = ${Si(a?.[2]??0)}`,"")}let s=new Map;for(let o of i.items){let a=o.params.asset;typeof a=="number"&&a>0&&!s.has(a)&&s.set(a,s.size+1)}for(let[o,a]of s){let l=i.assets.find(c=>c.number===o);e.push(`[[asset]]  # asset ${a}`,`mesh = ${JSON.stringify(l?.file||"PUT-THE-FILE-HERE.stl")}`,`unit = ${JSON.stringify(l?.unit??"m")}`,"")}let r=Ju(i.items);return i.items.forEach((o,a)=>{e.push(`[[${o.kind}]]`,`id = ${JSON.stringify(r[a])}`),o.probe&&e.push(`probe = ${o.probe}`);for(let[l,c]of ju(i.kinds.get(o.kind),o.params))e.push(`${l.name} = ${l.name==="asset"?s.get(c)??0:yv(l,c)}`);e.push("")}),e.join(`
`)}function ef(i){return i.replace(/(?:^|_)(\w)/g,(e,t)=>t.toUpperCase())}var _v={update:"PlaneUpdate",combine:"PlaneCombine",side:"Side",sides:"Sides",edge:"TaylorEdge",shape:"ConstraintShape",shading:"Shading","snag.law":"SnagLaw","texture.pattern":"TexturePattern"};function Ku(i){return i.replace(/(^|\.)static$/,"$1static_")}function xv(i,e){let t=n=>`{${n.map(Si).join(", ")}}`;return i.type==="choice"?`knurl::${_v[i.name]??ef(i.name)}::${String(e)}`:e==="inf"?"std::numeric_limits<double>::infinity()":e==="-inf"?"-std::numeric_limits<double>::infinity()":e==="automatic"?"knurl::automatic":typeof e=="number"?Si(e):i.type==="matrix"?`{.at = ${t(Qu(i,e).flat())}}`:i.type==="points"?`{.at = {${e.map(t).join(", ")}}, .count = ${e.length}}`:t(e)}function jm(i){let e=Ju(i.items).map(n=>n==="union"?"union_":n),t=["#include <chrono>","#include <cstdio>","#include <limits>","#include <thread>","","#include <knurl/client/client.hpp>","#include <knurl/reps/all.hpp>","","using namespace std::chrono_literals;","","int main() try {",'    auto client = knurl::Client::connect("knurl:default");',`    auto hand = client.claim(${JSON.stringify(i.device)});`];for(let[n,s,r]of i.probes)t.push(`    hand.place_probe(${n}, {.offset = {${s.map(Si).join(", ")}}, .radius = ${Si(r)}});`);return i.items.forEach((n,s)=>{t.push("",`    knurl::${ef(n.kind)} ${e[s]};`);for(let[r,o]of ju(i.kinds.get(n.kind),n.params))if(r.name==="asset"){let a=i.assets.find(l=>l.number===o)?.file;t.push(`    // ${e[s]}.asset = hand.send(knurl::Triangles{...}).asset;  // the mesh${a?` of ${a}`:""}, read by your program`)}else t.push(`    ${e[s]}.${Ku(r.name)} = ${xv(r,o)};`);t.push(`    auto ${e[s]}_handle = hand.add(${e[s]}${n.probe?`, {.probe = ${n.probe}}`:""});`)}),t.push("","    hand.arm();  // force may follow","    while (auto frame = hand.newest(1s)) {","        hand.commit();  // with HANDLE.set(...) before: one cycle, all of it",'        std::printf("%+.2f mm, %.2f N\\n", frame->position.z * 1e3, frame->sent_force.z);',"        std::this_thread::sleep_for(16ms);","    }","} catch (const knurl::Error& error) {",'    return std::fprintf(stderr, "%s\\n", error.what()), 1;',"}",""),t.join(`
`)}function Km(i,e){let t=n=>`(${n.map(Si).join(", ")})`;return e==="inf"?"knurl.INFINITY":e==="-inf"?"-knurl.INFINITY":e==="automatic"?"knurl.AUTOMATIC":typeof e=="string"?JSON.stringify(e):typeof e=="number"?i.type==="integer"?Si(e):mv(Si(e)):i.type==="matrix"?`(${Qu(i,e).map(t).join(", ")})`:i.type==="points"?`[${e.map(t).join(", ")}]`:t(e)}function Qm(i){let e=Ju(i.items),t=["import knurl","",`with knurl.connect() as client, client.claim(${JSON.stringify(i.device)}) as hand:`];for(let[n,s,r]of i.probes)t.push(`    hand.place_probe(${n}, offset=(${s.map(Si).join(", ")}), radius=${Si(r)})`);return i.items.forEach((n,s)=>{let r=ju(i.kinds.get(n.kind),n.params),o=r.filter(([c])=>!c.name.includes(".")&&c.name!=="asset").map(([c,h])=>`${Ku(c.name)}=${Km(c,h)}`);if(typeof n.params.asset=="number"&&n.params.asset>0){let c=i.assets.find(h=>h.number===n.params.asset)?.file??"the mesh";t.push(`    # sent_${e[s]} = hand.send_mesh(vertices, faces)  # ${c}, in m`),o.push(`# asset=sent_${e[s]}.asset`)}let a=o.findIndex(c=>c.startsWith("#")),l=a>=0?`  ${o.splice(a,1)[0]}`:"";t.push(`    ${e[s]} = knurl.${ef(n.kind)}(${o.join(", ")})${l}`);for(let[c,h]of r)c.name.includes(".")&&t.push(`    ${e[s]}.${Ku(c.name)} = ${Km(c,h)}`);t.push(`    ${e[s]} = hand.add(${e[s]}${n.probe?`, probe=${n.probe}`:""})`)}),t.push("    hand.arm()","    for report in hand.reports(rate=60):  # sends what has changed, each turn",'        print(f"{1e3 * report.position[2]:+.2f} mm, {report.sent_force[2]:.2f} N")',""),t.join(`
`)}function vv(i,e,t=0){let{radius:n}=e,s=Number.isFinite(e.kMax)?e.kMax:1e3,r=(a,l,c=!1)=>({low:Math.max(a,Tt(i.minimum,-1/0)),high:Math.min(l,Tt(i.maximum,1/0)),log:c}),o=i.name;if(o.startsWith("friction.")&&i.unit==="1")return r(0,2);if(o.startsWith("snag.d"))return r(1e-5,.01,!0);if(o==="snag.k_stick")return r(10,5e3,!0);if(o==="snag.k_kinetic")return r(0,2);if(o==="texture.amplitude")return r(1e-6,.001,!0);if(o==="texture.wavelength")return r(6e-5,.02,!0);if(o==="velocity")return r(-.1,.1);if(i.type==="vector")switch(i.unit){case"m":return o==="half_size"?r(0,n):o==="attach"?r(-n,n):{low:e.centre[t]-1.2*n,high:e.centre[t]+1.2*n,log:!1};case"N":return r(-e.peakForce,e.peakForce);case"N m":return r(-e.peakTorque,e.peakTorque);case"m/s^2":return r(-20,20);case"rad/s":return r(-6,6);default:return r(-1,1)}switch(i.unit){case"N/m":return r(5,1.2*s,!0);case"N s/m":return r(.02,20,!0);case"N m s/rad":return r(1e-5,.05,!0);case"m":return Tt(i.minimum,0)<0?r(-1.2*n,1.2*n):r(n/500,1.2*n,!0);case"1/m":return r(-200,200);case"N":return r(.01,e.peakForce,!0);case"kg":return r(.001,1,!0);case"s":return r(.001,2,!0);case"Hz":return r(1,400,!0);case"rad":return r(.01,Math.PI/2);default:return r(Math.max(-10,Tt(i.minimum,-10)),Math.min(10,Tt(i.maximum,10)))}}function bv(i,e){if(!e.log)return Math.round(1e3*(i-e.low)/(e.high-e.low||1));if(i<=0)return 0;let t=1+999*Math.log(i/e.low)/Math.log(e.high/e.low);return Math.round(Math.min(1e3,Math.max(1,t)))}function eg(i,e,t=!0){return+(e.log?i<=0&&t?0:e.low*(e.high/e.low)**((Math.max(1,i)-1)/999):e.low+i/1e3*(e.high-e.low)).toPrecision(4)}function tf(i,e){return e.startsWith(i)?e:`${i}: ${e}`}var Xi=(i,e)=>Math.round(e*(Number.isFinite(i.kMax)?i.kMax:1e3)),ng=[{name:"Floor",kind:"plane",params:i=>({normal:[0,0,1],offset:i.centre[2]-.15*i.radius,stiffness:Xi(i,.35),damping:1})},{name:"Wall",kind:"plane",params:i=>({normal:[1,0,0],offset:i.centre[0]-.35*i.radius,stiffness:Xi(i,.5),damping:1})},{name:"Soft ball",kind:"sphere",params:i=>({center:[i.centre[0]-.1*i.radius,i.centre[1],i.centre[2]-.3*i.radius],radius:.3*i.radius,stiffness:Xi(i,.1),damping:1})},{name:"Box",kind:"box",params:i=>({center:[i.centre[0],i.centre[1],i.centre[2]-.4*i.radius],half_size:[.35*i.radius,.35*i.radius,.2*i.radius],stiffness:Xi(i,.35),damping:1})},{name:"Room",kind:"box",params:i=>({center:[...i.centre],half_size:[.6*i.radius,.6*i.radius,.6*i.radius],side:"inside",stiffness:Xi(i,.35),damping:1})},{name:"Icy floor",kind:"plane",params:i=>({offset:i.centre[2]-.15*i.radius,stiffness:Xi(i,.6),"friction.static":.05,"friction.dynamic":.03})},{name:"Sandpaper",kind:"plane",params:i=>({offset:i.centre[2]-.15*i.radius,stiffness:Xi(i,.6),damping:1,"snag.k_kinetic":.6,"snag.k_stick":2e3,"snag.d_snap":45e-5,"snag.d_mean":4e-4,"snag.d_spread":2e-4})},{name:"Rubber",kind:"plane",params:i=>({offset:i.centre[2]-.15*i.radius,stiffness:Math.min(600,Xi(i,.8)),damping:3,"friction.static":1.1,"friction.dynamic":.8})},{name:"Spring to here",kind:"spring",params:(i,e)=>({anchor:[...e],stiffness:60,damping:1})},{name:"Magnet",kind:"magnet",params:i=>({position:[...i.centre],radius:.2*i.radius,stiffness:200,max_force:Math.min(2,.4*i.peakForce),max_distance:.3*i.radius})},{name:"Viscous water",kind:"viscosity",params:()=>({damping:3})},{name:"Vibration",kind:"vibration",params:()=>({direction:[0,0,1],amplitude:.4,frequency:80})},{name:"Gravity",kind:"gravity",params:()=>({mass:.1})},{name:"Rail",kind:"constraint",params:i=>({shape:"line",origin:[...i.centre],direction:[0,1,0],stiffness:Xi(i,.2),damping:1})},{name:"Bowl field",kind:"taylor",params:i=>({origin:[...i.centre],jacobian:[-60,0,0,0,-60,0,0,0,-60],radius:.6*i.radius,edge:"fade"})}];function Mv(i,e,t){let n=ng.find(l=>l.kind===i);if(n)return n.params(e,t);let s={stiffness:Xi(e,.35),damping:1},r=e.centre,o=e.radius,a=[r[0],r[1],r[2]-.3*o];switch(i){case"cap":return{foot:a,curvature:-1/o,...s};case"polygon":return{vertices:[[-1,-1],[1,-1],[1,1],[-1,1]].map(([l,c])=>[r[0]+.4*o*l,r[1]+.4*o*c,a[2]]),...s};case"half_plane":return{offset:a[2],edge:[1,0,0],edge_offset:r[0],...s};case"capsule":return{center:a,axis:[0,1,0],half_length:.25*o,radius:.12*o,...s};case"cylinder":return{center:a,half_length:.15*o,radius:.25*o,...s};case"torus":return{center:a,radius:.3*o,tube:.08*o,...s};case"constant_force":return{force:[0,0,-Math.min(1,.2*e.peakForce)]};case"taylor6":return{origin:[...r],radius:.5*o};default:return{}}}function Sv([i,e,t]){let[n,s,r,o,a,l]=[i,e,t].flatMap(c=>[Math.cos(c/2),Math.sin(c/2)]);return[n*r*a+s*o*l,s*r*a-n*o*l,n*o*a+s*r*l,n*r*l-s*o*a]}function tg([i,e,t,n]){return[Math.atan2(2*(i*e+t*n),1-2*(e*e+t*t)),Math.asin(Math.max(-1,Math.min(1,2*(i*t-n*e)))),Math.atan2(2*(i*n+e*t),1-2*(t*t+n*n))]}var wv=["center","position","anchor","origin","foot"],kl=class{constructor(e,t){this.model=e;this.connection=t;oe("presets").append(...ng.map(n=>Fe("button.small",{type:"button","data-preset":n.name,click:()=>{this.addPreset(n)}},n.name))),oe("add").addEventListener("click",()=>{this.addKind()}),oe("restore").addEventListener("click",()=>{this.restore()}),oe("clear").addEventListener("click",()=>{this.clear()}),oe("arm-mine").addEventListener("click",()=>{this.ask("arm")});for(let[n,s,r]of[["to-toml","scene.toml",Jm],["to-cpp","scene.cpp",jm],["to-python","scene.py",Qm]])oe(n).addEventListener("click",()=>{let o=this.exported();if(!o)return ut("warning","There is nothing to export: nobody has added anything.");let a=r(o);oe("exported").value=a,oe("export-name").textContent=s,oe("export-dialog").showModal()});oe("export-save").addEventListener("click",()=>br(oe("export-name").textContent??"scene.txt",oe("exported").value)),oe("export-copy").addEventListener("click",()=>{let n=oe("exported");navigator.clipboard?.writeText(n.value).then(()=>ut("info","Copied."),()=>(n.select(),ut("warning","The browser does not let the page copy: press Ctrl+C.")))}),oe("mesh-file").addEventListener("change",n=>{let s=n.target;for(let r of s.files??[])this.loadMesh(r);s.value=""}),e.on("hello",()=>this.kinds()),e.on("scene",()=>this.show()),e.on("selected",()=>this.show())}model;connection;slot=null;rows=[];shownKey="";listed="";waiting=new Map;local=new Map;touchedAt=0;lost=new Map;units=new Map;files=new Map;get device(){return this.model.recording?void 0:this.model.current()}reach(e){let t=e.mine()?.frame,n=t?.scale??1,s=e.info.centre,r=t?[0,1,2].map(o=>(s[o]-t.device_centre[o])*n+t.world_centre[o]):s;return{kMax:e.kMax()/(n||1),radius:e.info.radius*n,centre:r,peakForce:e.info.peak_force||8,peakTorque:e.info.peak_torque||.2}}hand(e){let t=e.frame?.p??e.info.centre,n=e.mine()?.frame;return n?[0,1,2].map(s=>(t[s]-n.device_centre[s])*n.scale+n.world_centre[s]):[...t]}kinds(){oe("kind").replaceChildren(...[!0,!1].map(t=>Fe("optgroup",{label:t?"surfaces":"effects"},...[...this.model.kinds.values()].filter(n=>n.surface===t).map(n=>Fe("option",{value:n.name},n.name.replaceAll("_"," "))))));let e=this.model.can("render");oe("playground-body").toggleAttribute("inert",!e),oe("playground-why").hidden=e,oe("arm-mine").hidden=!this.model.can("control"),this.shownKey="",this.show()}async request(e,t){try{return await this.connection().request(e,t)}catch(n){return ut("error",n.message),null}}async ask(e){let t=this.device;t&&await this.request(e,{device:t.info.i})}async add(e,t,n=this.device){if(!n)return ut("warning","There is no device to add something to.");let s=Number(oe("probe").value)||0,r=await this.request("add",{device:n.info.i,kind:e,params:t,probe:s});if(!r)return;this.slot=r.slot;let o=Tt(t.stiffness),a=Tt(r.applied_stiffness);a>0&&Number.isFinite(o)&&a<.999*o&&ut("info",`The device allows ${Math.round(a)} N/m of the ${Math.round(o)} N/m that were asked for.`),this.shownKey="",this.show(),n.state==="idle"&&ut("info",this.model.can("control")?"Added. No force yet: press Arm.":"Added. No force yet: a page with the role control has to arm.")}addPreset(e){let t=this.device;return t?this.add(e.kind,e.params(this.reach(t),this.hand(t))):Promise.resolve(ut("warning","There is no device to add something to."))}addKind(){let e=this.device;if(!e)return Promise.resolve(ut("warning","There is no device to add something to."));let t=oe("kind").value;return this.add(t,Mv(t,this.reach(e),this.hand(e)))}async clear(){let e=this.device;e&&(this.lost.delete(e.info.name),await this.request("clear",{device:e.info.i}))}remember(){for(let e of this.model.devices.values()){let t=e.mine(),n=t?this.model.itemsOf(e,t.claim).filter(s=>s.kind!=="shape"):[];n.length&&this.lost.set(e.info.name,n)}}async restore(){let e=this.device,t=e&&this.lost.get(e.info.name);if(!(!e||!t)){this.lost.delete(e.info.name);for(let n of t)await this.request("add",{device:e.info.i,kind:n.kind,params:n.params,probe:n.probe});this.show()}}change(e,t,n){let s=`${e.info.i}:${t}`;this.local.set(s,{...this.local.get(s),...n});let r=this.waiting.get(s)??{device:e.info.i,slot:t,params:{},busy:!1};Object.assign(r.params,n),this.waiting.set(s,r),this.touchedAt=performance.now(),r.busy||this.send(s)}async send(e){let t=this.waiting.get(e);if(t){for(t.busy=!0;Object.keys(t.params).length;){let n=t.params;if(t.params={},!await this.request("set",{device:t.device,slot:t.slot,params:n}))break}this.waiting.delete(e),window.setTimeout(()=>{this.waiting.has(e)||(this.local.delete(e),this.refresh())},300)}}drag(e,t,n){let s={...t.params,...this.local.get(`${e.info.i}:${t.slot}`)},r=wv.find(a=>Array.isArray(s[a])&&s[a].length===3),o=a=>a.map((l,c)=>l+n[c]);r?this.change(e,t.slot,{[r]:o(s[r])}):t.kind==="polygon"?this.change(e,t.slot,{vertices:s.vertices.map(o)}):Array.isArray(s.normal)&&this.change(e,t.slot,{offset:Tt(s.offset)+s.normal.reduce((a,l,c)=>a+l*n[c],0)}),this.refresh()}show(){let e=this.device,t=e?.mine(),n=e&&t?this.model.itemsOf(e,t.claim):[];(this.slot===null||!n.some(c=>c.slot===this.slot))&&(this.slot=n.length?n[n.length-1].slot:null),oe("lost-box").hidden=!(e&&this.lost.has(e.info.name)&&n.length===0);let s=oe("items"),r=n.map(c=>`${c.slot}:${c.kind}:${c.slot===this.slot}`).join()+String(n.length);r!==this.listed&&(this.listed=r,s.replaceChildren(...n.map(c=>Fe("li",{},Fe("button.item",{type:"button","aria-pressed":String(c.slot===this.slot),click:()=>(this.slot=c.slot,this.shownKey="",this.show())},`${c.kind.replaceAll("_"," ")} `,Fe("small",{},`slot ${c.slot}`)),Fe("button.small.remove",{type:"button","aria-label":`remove ${c.kind} in slot ${c.slot}`,title:"remove",click:()=>{this.request("remove",{device:e.info.i,slot:c.slot})}},"✕"))))),oe("items-empty").hidden=n.length>0;let o=n.find(c=>c.slot===this.slot),a=oe("editor");if(a.hidden=!o,!o||!e||!t){this.shownKey="";return}let l=`${e.info.i}:${t.claim}:${o.slot}:${o.generation}:${o.kind}`;l!==this.shownKey&&(this.shownKey=l,this.build(e,o)),this.refresh()}refresh(){let e=this.device,t=e?.mine();if(!e||!t||this.slot===null)return;let n=e.items.get(`${t.claim}:${this.slot}`);if(!n)return;let s={...n.params,...this.local.get(`${e.info.i}:${n.slot}`)};for(let r of this.rows)r.show(s[r.field.name]??r.field.default)}build(e,t){let n=this.model.kinds.get(t.kind),s=oe("editor");this.rows=[];let r=new Map;s.replaceChildren(Fe("h3",{},`${t.kind.replaceAll("_"," ")}, slot ${t.slot}`));for(let o of n?.fields??[]){let a=o.name.includes(".")?o.name.split(".")[0]:["recovery","braking","velocity","angular_velocity","update","combine"].includes(o.name)&&n?.surface?"more":"",l=s;a&&(l=r.get(a)??Fe("details",{},Fe("summary",{},a)),r.has(a)||(r.set(a,l),(n?.fields??[]).some(h=>h.name.startsWith(`${a}.`)&&Tt(t.params[h.name])>0&&h.type==="real"&&t.params[h.name]!==h.default)&&l.setAttribute("open",""))),l.append(this.row(e,t,o))}s.append(...r.values())}row(e,t,n){let s=this.reach(e),r=d=>this.change(e,t.slot,{[n.name]:d}),o=()=>this.local.get(`${e.info.i}:${t.slot}`)?.[n.name]??e.items.get(`${t.claim}:${t.slot}`)?.params[n.name]??n.default,a=n.name.includes(".")?n.name.split(".")[1]:n.name,l=Fe("div.label",{title:`${n.meaning}${n.unit?` (${n.unit})`:""}`},a.replaceAll("_"," "),Fe("span.unit",{},n.unit&&n.unit!=="1"?` ${n.unit}`:"")),c=Fe("div.field",{"data-field":n.name},l),h=d=>document.activeElement===d&&performance.now()-this.touchedAt<1500;if(n.type==="choice"){let d=Fe("select",{"aria-label":n.name},...(n.choices??[]).map(y=>Fe("option",{value:y},y.replaceAll("_"," "))));return d.addEventListener("change",()=>r(d.value)),c.append(d),this.rows.push({field:n,show:y=>{d.value=String(y)}}),c}if(n.type==="matrix"||n.type==="points"){let d=Fe("textarea",{"aria-label":n.name,rows:n.type==="matrix"?n.count===36||n.count===6?6:3:4,spellcheck:"false"});return d.addEventListener("change",()=>{let y=d.value.trim().split(`
`).map(w=>w.trim().split(/[\s,]+/).map(Number));if(y.some(w=>w.some(v=>!Number.isFinite(v))))return ut("error",`${t.kind}.${n.name}: numbers, row by row, separated by spaces`);r(n.type==="matrix"?y.flat():y)}),c.append(d),c.classList.add("wide"),this.rows.push({field:n,show:y=>{if(document.activeElement===d||!Array.isArray(y))return;let w=y;if(!Array.isArray(y[0])){let v=Math.sqrt(y.length);w=Array.from({length:v},(E,S)=>y.slice(S*v,S*v+v))}d.value=w.map(v=>v.map(E=>+E.toPrecision(5)).join(" ")).join(`
`)}}),c}if(n.type==="integer"){let d=Fe("input",{type:"number",min:Tt(n.minimum,0),max:Tt(n.maximum,4294967295),step:1,"aria-label":n.name});return d.addEventListener("change",()=>r(Math.round(Number(d.value))||0)),c.append(d),this.rows.push({field:n,show:y=>{document.activeElement===d||(d.value=String(y))}}),c}let u=n.type==="vector"||n.type==="quaternion",f=n.type==="quaternion",p=!u&&(n.automatic?"automatic":n.infinity?"inf":""),g=[],x=(d,y)=>{if(!Number.isFinite(y))return;if(!u)return r(y);let w=f?tg(o()):[...o()].map(v=>Tt(v));w[d]=f?y*Math.PI/180:y,r(f?Sv(w):w)};for(let d=0;d<(u?3:1);d++){let y=f?{low:-180,high:180,log:!1}:vv(n,s,d),w=u?`${n.name} ${"xyz"[d]}`:n.name,v=Fe("input",{type:"range",min:0,max:1e3,step:1,"aria-label":w}),E=Fe("input",{type:"number",step:"any","aria-label":`${w}, as a number`}),S=Tt(n.minimum,0)<=0;v.addEventListener("input",()=>{let M=eg(Number(v.value),y,S);E.value=String(M),x(d,M)}),E.addEventListener("change",()=>{if(E.value.trim()===""||!Number.isFinite(Number(E.value)))return ut("error",`${t.kind}.${n.name}: a number is missing`);x(d,Number(E.value))});let _=Fe("div.slide",{},u?Fe("span.axis",{"data-axis":"xyz"[d]},"xyz"[d]):Fe("span.axis"),v,E);g.push({slider:v,number:E,range:y}),c.append(_)}let m=null;return p&&(m=Fe("input",{type:"checkbox","aria-label":`${n.name} ${p}`}),m.addEventListener("change",()=>r(m.checked?p:p==="inf"?Number.isFinite(s.kMax)&&n.unit==="N/m"?Math.round(.35*s.kMax):.1:eg(300,g[0].range))),c.append(Fe("label.check",{},m,p==="inf"?n.unit==="N/m"?"as stiff as the device allows":"endless":p))),this.rows.push({field:n,show:d=>{m&&(m.checked=d===p);let y=f?tg(d).map(w=>w*180/Math.PI):u?d.map(w=>Tt(w)):[Tt(d,NaN)];g.forEach(({slider:w,number:v,range:E},S)=>{let _=!Number.isFinite(y[S]);w.disabled=v.disabled=_&&p!=="",h(w)||(w.value=String(_?d==="inf"?1e3:0:bv(y[S],E))),document.activeElement!==v&&(v.value=_?"":String(+y[S].toPrecision(4)))})}}),c}async loadMesh(e){let t=this.device;if(!t)return ut("warning","There is no device to send a mesh to.");if(!this.model.can("render"))return ut("error",`${e.name}: this page may only look on; start knurl-web with the role render or control`);if(!/\.(stl|obj|ply)$/i.test(e.name))return ut("error",`${e.name}: neither STL, OBJ nor PLY; export it as one of these`);let n=oe("mesh-unit").value;Mt(oe("mesh-state"),`Sending ${e.name}, ${(e.size/1e6).toFixed(1)} MB ...`);try{let s=await fetch(`./mesh?device=${t.info.i}&name=${encodeURIComponent(e.name)}${n?`&unit=${n}`:""}`,{method:"POST",body:e}),r=await s.text(),o={};try{o=JSON.parse(r)}catch{}if(!s.ok||!o.ok)throw new Error(o.error??`refused (${s.status})`);this.units.set(e.name,n),oe("mesh-state").textContent?.startsWith("Sending")&&Mt(oe("mesh-state"),`The servo reads ${e.name} ...`)}catch(s){Mt(oe("mesh-state"),""),ut("error",tf(e.name,s.message))}}async sent(e){let t=this.model.devices.get(e.device);if(!e.ok||e.asset===void 0)return Mt(oe("mesh-state"),""),ut("error",tf(e.name,e.error??"refused without a reason"));if(!t)return;this.files.set(`${e.device}:${e.asset}`,{number:e.asset,file:e.name,unit:this.units.get(e.name)||"mm"});let{low:n,high:s}=e,r=n&&s?`, ${n.map((l,c)=>uo(s[c]-l,"m")).join(" × ")}`:"";Mt(oe("mesh-state"),`${e.name}: ${e.triangles??e.faces} triangles${r}, asset ${e.asset}.`);for(let l of[e.notes??[]].flat())l&&ut("info",tf(e.name,l));let o=this.reach(t),a=n&&s?o.centre.map((l,c)=>l-(n[c]+s[c])/2):o.centre;await this.add("shape",{asset:e.asset,position:a,stiffness:Xi(o,.3),damping:1},t)}exported(){let e=this.model.current();if(!e)return null;let t=e.mine()??[...e.claims.values()].find(r=>this.model.itemsOf(e,r.claim).length>0);if(!t)return null;let n=this.model.itemsOf(e,t.claim);if(!n.length)return null;let s=[...this.files].filter(([r])=>r.startsWith(`${e.info.i}:`)).map(([,r])=>r);return{kinds:this.model.kinds,items:n,assets:s,probes:t.probes,device:e.info.name}}};function Av({polynomial:i,numTables:e}){let t=new Uint32Array(256*e);for(let n=0;n<256;n++){let s=n;s=(s&1)*i^s>>>1,s=(s&1)*i^s>>>1,s=(s&1)*i^s>>>1,s=(s&1)*i^s>>>1,s=(s&1)*i^s>>>1,s=(s&1)*i^s>>>1,s=(s&1)*i^s>>>1,s=(s&1)*i^s>>>1,t[n]=s}for(let n=256;n<t.length;n++){let s=t[n-256];t[n]=t[s&255]^s>>>8}return t}var cs=Av({polynomial:3988292384,numTables:8});function nf(){return-1}function sf(i,e){let t=e.byteLength,n=new DataView(e.buffer,e.byteOffset,t),s=i,r=0,o=-n.byteOffset&3;for(;r<o&&r<t;r++)s=cs[(s^n.getUint8(r))&255]^s>>>8;if(r===t)return s;r=o;let a=t-r;for(;a>=8;r+=8,a-=8){s^=n.getUint32(r,!0);let l=n.getUint32(r+4,!0);s=cs[0*256+(l>>>24&255)]^cs[1*256+(l>>>16&255)]^cs[2*256+(l>>>8&255)]^cs[3*256+(l>>>0&255)]^cs[4*256+(s>>>24&255)]^cs[5*256+(s>>>16&255)]^cs[6*256+(s>>>8&255)]^cs[7*256+(s>>>0&255)]}for(let l=r;l<t;l++)s=cs[(s^n.getUint8(l))&255]^s>>>8;return s}function rf(i){return(i^-1)>>>0}function Mr(i){return rf(sf(nf(),i))}var kt=function(i,e,t,n){function s(r){return r instanceof t?r:new t(function(o){o(r)})}return new(t||(t=Promise))(function(r,o){function a(h){try{c(n.next(h))}catch(u){o(u)}}function l(h){try{c(n.throw(h))}catch(u){o(u)}}function c(h){h.done?r(h.value):s(h.value).then(a,l)}c((n=n.apply(i,e||[])).next())})},Lt=function(i,e){var t={label:0,sent:function(){if(r[0]&1)throw r[1];return r[1]},trys:[],ops:[]},n,s,r,o=Object.create((typeof Iterator=="function"?Iterator:Object).prototype);return o.next=a(0),o.throw=a(1),o.return=a(2),typeof Symbol=="function"&&(o[Symbol.iterator]=function(){return this}),o;function a(c){return function(h){return l([c,h])}}function l(c){if(n)throw new TypeError("Generator is already executing.");for(;o&&(o=0,c[0]&&(t=0)),t;)try{if(n=1,s&&(r=c[0]&2?s.return:c[0]?s.throw||((r=s.return)&&r.call(s),0):s.next)&&!(r=r.call(s,c[1])).done)return r;switch(s=0,r&&(c=[c[0]&2,r.value]),c[0]){case 0:case 1:r=c;break;case 4:return t.label++,{value:c[1],done:!1};case 5:t.label++,s=c[1],c=[0];continue;case 7:c=t.ops.pop(),t.trys.pop();continue;default:if(r=t.trys,!(r=r.length>0&&r[r.length-1])&&(c[0]===6||c[0]===2)){t=0;continue}if(c[0]===3&&(!r||c[1]>r[0]&&c[1]<r[3])){t.label=c[1];break}if(c[0]===6&&t.label<r[1]){t.label=r[1],r=c;break}if(r&&t.label<r[2]){t.label=r[2],t.ops.push(c);break}r[2]&&t.ops.pop(),t.trys.pop();continue}c=e.call(i,t)}catch(h){c=[6,h],s=0}finally{n=r=0}if(c[0]&5)throw c[1];return{value:c[0]?c[1]:void 0,done:!0}}},wi=function(i,e){var t=typeof Symbol=="function"&&i[Symbol.iterator];if(!t)return i;var n=t.call(i),s,r=[],o;try{for(;(e===void 0||e-- >0)&&!(s=n.next()).done;)r.push(s.value)}catch(a){o={error:a}}finally{try{s&&!s.done&&(t=n.return)&&t.call(n)}finally{if(o)throw o.error}}return r},Fi=function(i,e,t){if(t||arguments.length===2)for(var n=0,s=e.length,r;n<s;n++)(r||!(n in e))&&(r||(r=Array.prototype.slice.call(e,0,n)),r[n]=e[n]);return i.concat(r||Array.prototype.slice.call(e))},ig=function(i){var e=typeof Symbol=="function"&&Symbol.iterator,t=e&&i[e],n=0;if(t)return t.call(i);if(i&&typeof i.length=="number")return{next:function(){return i&&n>=i.length&&(i=void 0),{value:i&&i[n++],done:!i}}};throw new TypeError(e?"Object is not iterable.":"Symbol.iterator is not defined.")},eT=(function(){function i(e){e===void 0&&(e=i.minComparator);var t=this;this.compare=e,this.heapArray=[],this._limit=0,this.offer=this.add,this.element=this.peek,this.poll=this.pop,this._invertedCompare=function(n,s){return t.compare(n,s).then(function(r){return-1*r})}}return i.getChildrenIndexOf=function(e){return[e*2+1,e*2+2]},i.getParentIndexOf=function(e){if(e<=0)return-1;var t=e%2?1:2;return Math.floor((e-t)/2)},i.getSiblingIndexOf=function(e){if(e<=0)return-1;var t=e%2?1:-1;return e+t},i.minComparator=function(e,t){return kt(this,void 0,void 0,function(){return Lt(this,function(n){return e>t?[2,1]:e<t?[2,-1]:[2,0]})})},i.maxComparator=function(e,t){return kt(this,void 0,void 0,function(){return Lt(this,function(n){return t>e?[2,1]:t<e?[2,-1]:[2,0]})})},i.minComparatorNumber=function(e,t){return kt(this,void 0,void 0,function(){return Lt(this,function(n){return[2,e-t]})})},i.maxComparatorNumber=function(e,t){return kt(this,void 0,void 0,function(){return Lt(this,function(n){return[2,t-e]})})},i.defaultIsEqual=function(e,t){return kt(this,void 0,void 0,function(){return Lt(this,function(n){return[2,e===t]})})},i.print=function(e){function t(h){var u=i.getParentIndexOf(h);return Math.floor(Math.log2(u+1))}function n(h,u){for(var f="";u>0;--u)f+=h;return f}for(var s=0,r=[],o=t(e.length-1)+2,a=0;s<e.length;){var l=t(s)+1;s===0&&(l=0);var c=String(e.get(s));c.length>a&&(a=c.length),r[l]=r[l]||[],r[l].push(c),s+=1}return r.map(function(h,u){var f=Math.pow(2,o-u)-1;return n(" ",Math.floor(f/2)*a)+h.map(function(p){var g=(a-p.length)/2;return n(" ",Math.ceil(g))+p+n(" ",Math.floor(g))}).join(n(" ",f*a))}).join(`
`)},i.heapify=function(e,t){return kt(this,void 0,void 0,function(){var n;return Lt(this,function(s){switch(s.label){case 0:return n=new i(t),n.heapArray=e,[4,n.init()];case 1:return s.sent(),[2,n]}})})},i.heappop=function(e,t){var n=new i(t);return n.heapArray=e,n.pop()},i.heappush=function(e,t,n){return kt(this,void 0,void 0,function(){var s;return Lt(this,function(r){switch(r.label){case 0:return s=new i(n),s.heapArray=e,[4,s.push(t)];case 1:return r.sent(),[2]}})})},i.heappushpop=function(e,t,n){var s=new i(n);return s.heapArray=e,s.pushpop(t)},i.heapreplace=function(e,t,n){var s=new i(n);return s.heapArray=e,s.replace(t)},i.heaptop=function(e,t,n){t===void 0&&(t=1);var s=new i(n);return s.heapArray=e,s.top(t)},i.heapbottom=function(e,t,n){t===void 0&&(t=1);var s=new i(n);return s.heapArray=e,s.bottom(t)},i.nlargest=function(e,t,n){return kt(this,void 0,void 0,function(){var s;return Lt(this,function(r){switch(r.label){case 0:return s=new i(n),s.heapArray=Fi([],wi(t),!1),[4,s.init()];case 1:return r.sent(),[2,s.top(e)]}})})},i.nsmallest=function(e,t,n){return kt(this,void 0,void 0,function(){var s;return Lt(this,function(r){switch(r.label){case 0:return s=new i(n),s.heapArray=Fi([],wi(t),!1),[4,s.init()];case 1:return r.sent(),[2,s.bottom(e)]}})})},i.prototype.add=function(e){return kt(this,void 0,void 0,function(){return Lt(this,function(t){switch(t.label){case 0:return[4,this._sortNodeUp(this.heapArray.push(e)-1)];case 1:return t.sent(),this._applyLimit(),[2,!0]}})})},i.prototype.addAll=function(e){return kt(this,void 0,void 0,function(){var t,n,s;return Lt(this,function(r){switch(r.label){case 0:t=this.length,(s=this.heapArray).push.apply(s,Fi([],wi(e),!1)),n=this.length,r.label=1;case 1:return t<n?[4,this._sortNodeUp(t)]:[3,4];case 2:r.sent(),r.label=3;case 3:return++t,[3,1];case 4:return this._applyLimit(),[2,!0]}})})},i.prototype.bottom=function(){return kt(this,arguments,void 0,function(e){return e===void 0&&(e=1),Lt(this,function(t){return this.heapArray.length===0||e<=0?[2,[]]:this.heapArray.length===1?[2,[this.heapArray[0]]]:e>=this.heapArray.length?[2,Fi([],wi(this.heapArray),!1)]:[2,this._bottomN_push(~~e)]})})},i.prototype.check=function(){return kt(this,void 0,void 0,function(){var e,t,n,s,r,o,a,l,c;return Lt(this,function(h){switch(h.label){case 0:e=0,h.label=1;case 1:if(!(e<this.heapArray.length))return[3,10];t=this.heapArray[e],n=this.getChildrenOf(e),h.label=2;case 2:h.trys.push([2,7,8,9]),s=(l=void 0,ig(n)),r=s.next(),h.label=3;case 3:return r.done?[3,6]:(o=r.value,[4,this.compare(t,o)]);case 4:if(h.sent()>0)return[2,t];h.label=5;case 5:return r=s.next(),[3,3];case 6:return[3,9];case 7:return a=h.sent(),l={error:a},[3,9];case 8:try{r&&!r.done&&(c=s.return)&&c.call(s)}finally{if(l)throw l.error}return[7];case 9:return++e,[3,1];case 10:return[2]}})})},i.prototype.clear=function(){this.heapArray=[]},i.prototype.clone=function(){var e=new i(this.comparator());return e.heapArray=this.toArray(),e._limit=this._limit,e},i.prototype.comparator=function(){return this.compare},i.prototype.contains=function(e){return kt(this,arguments,void 0,function(t,n){var s,r,o,a,l,c;return n===void 0&&(n=i.defaultIsEqual),Lt(this,function(h){switch(h.label){case 0:h.trys.push([0,5,6,7]),s=ig(this.heapArray),r=s.next(),h.label=1;case 1:return r.done?[3,4]:(o=r.value,[4,n(o,t)]);case 2:if(h.sent())return[2,!0];h.label=3;case 3:return r=s.next(),[3,1];case 4:return[3,7];case 5:return a=h.sent(),l={error:a},[3,7];case 6:try{r&&!r.done&&(c=s.return)&&c.call(s)}finally{if(l)throw l.error}return[7];case 7:return[2,!1]}})})},i.prototype.init=function(e){return kt(this,void 0,void 0,function(){var t;return Lt(this,function(n){switch(n.label){case 0:e&&(this.heapArray=Fi([],wi(e),!1)),t=i.getParentIndexOf(this.length-1),n.label=1;case 1:return t>=0?[4,this._sortNodeDown(t)]:[3,4];case 2:n.sent(),n.label=3;case 3:return--t,[3,1];case 4:return this._applyLimit(),[2]}})})},i.prototype.isEmpty=function(){return this.length===0},i.prototype.leafs=function(){if(this.heapArray.length===0)return[];var e=i.getParentIndexOf(this.heapArray.length-1);return this.heapArray.slice(e+1)},Object.defineProperty(i.prototype,"length",{get:function(){return this.heapArray.length},enumerable:!1,configurable:!0}),Object.defineProperty(i.prototype,"limit",{get:function(){return this._limit},set:function(e){this._limit=~~e,this._applyLimit()},enumerable:!1,configurable:!0}),i.prototype.peek=function(){return this.heapArray[0]},i.prototype.pop=function(){return kt(this,void 0,void 0,function(){var e;return Lt(this,function(t){return e=this.heapArray.pop(),this.length>0&&e!==void 0?[2,this.replace(e)]:[2,e]})})},i.prototype.push=function(){for(var e=[],t=0;t<arguments.length;t++)e[t]=arguments[t];return kt(this,void 0,void 0,function(){return Lt(this,function(n){return e.length<1?[2,!1]:e.length===1?[2,this.add(e[0])]:[2,this.addAll(e)]})})},i.prototype.pushpop=function(e){return kt(this,void 0,void 0,function(){var t;return Lt(this,function(n){switch(n.label){case 0:return[4,this.compare(this.heapArray[0],e)];case 1:return n.sent()<0?(t=wi([this.heapArray[0],e],2),e=t[0],this.heapArray[0]=t[1],[4,this._sortNodeDown(0)]):[3,3];case 2:n.sent(),n.label=3;case 3:return[2,e]}})})},i.prototype.remove=function(e){return kt(this,arguments,void 0,function(t,n){var s,r,o,a=this;return n===void 0&&(n=i.defaultIsEqual),Lt(this,function(l){switch(l.label){case 0:return this.heapArray.length?t!==void 0?[3,2]:[4,this.pop()]:[2,!1];case 1:return l.sent(),[2,!0];case 2:s=[0],l.label=3;case 3:return s.length?(r=s.shift(),[4,n(this.heapArray[r],t)]):[3,13];case 4:return l.sent()?r!==0?[3,6]:[4,this.pop()]:[3,11];case 5:return l.sent(),[3,10];case 6:return r!==this.heapArray.length-1?[3,7]:(this.heapArray.pop(),[3,10]);case 7:return this.heapArray.splice(r,1,this.heapArray.pop()),[4,this._sortNodeUp(r)];case 8:return l.sent(),[4,this._sortNodeDown(r)];case 9:l.sent(),l.label=10;case 10:return[2,!0];case 11:o=i.getChildrenIndexOf(r).filter(function(c){return c<a.heapArray.length}),s.push.apply(s,Fi([],wi(o),!1)),l.label=12;case 12:return[3,3];case 13:return[2,!1]}})})},i.prototype.replace=function(e){return kt(this,void 0,void 0,function(){var t;return Lt(this,function(n){switch(n.label){case 0:return t=this.heapArray[0],this.heapArray[0]=e,[4,this._sortNodeDown(0)];case 1:return n.sent(),[2,t]}})})},i.prototype.size=function(){return this.length},i.prototype.top=function(){return kt(this,arguments,void 0,function(e){return e===void 0&&(e=1),Lt(this,function(t){return this.heapArray.length===0||e<=0?[2,[]]:this.heapArray.length===1||e===1?[2,[this.heapArray[0]]]:e>=this.heapArray.length?[2,Fi([],wi(this.heapArray),!1)]:[2,this._topN_push(~~e)]})})},i.prototype.toArray=function(){return Fi([],wi(this.heapArray),!1)},i.prototype.toString=function(){return this.heapArray.toString()},i.prototype.get=function(e){return this.heapArray[e]},i.prototype.getChildrenOf=function(e){var t=this;return i.getChildrenIndexOf(e).map(function(n){return t.heapArray[n]}).filter(function(n){return n!==void 0})},i.prototype.getParentOf=function(e){var t=i.getParentIndexOf(e);return this.heapArray[t]},i.prototype[Symbol.iterator]=function(){return Lt(this,function(e){switch(e.label){case 0:return this.length?[4,this.pop()]:[3,2];case 1:return e.sent(),[3,0];case 2:return[2]}})},i.prototype.iterator=function(){return this},i.prototype._applyLimit=function(){if(this._limit&&this._limit<this.heapArray.length)for(var e=this.heapArray.length-this._limit;e;)this.heapArray.pop(),--e},i.prototype._bottomN_push=function(e){return kt(this,void 0,void 0,function(){var t,n,s,r,a,o,a;return Lt(this,function(l){switch(l.label){case 0:return t=new i(this.compare),t.limit=e,t.heapArray=this.heapArray.slice(-e),[4,t.init()];case 1:for(l.sent(),n=this.heapArray.length-1-e,s=i.getParentIndexOf(n),r=[],a=n;a>s;--a)r.push(a);o=this.heapArray,l.label=2;case 2:return r.length?(a=r.shift(),[4,this.compare(o[a],t.peek())]):[3,6];case 3:return l.sent()>0?[4,t.replace(o[a])]:[3,5];case 4:l.sent(),a%2&&r.push(i.getParentIndexOf(a)),l.label=5;case 5:return[3,2];case 6:return[2,t.toArray()]}})})},i.prototype._moveNode=function(e,t){var n=this.heapArray[e];this.heapArray[e]=this.heapArray[t],this.heapArray[t]=n},i.prototype._sortNodeDown=function(e){return kt(this,void 0,void 0,function(){var t,n,s,r,o,a,l;return Lt(this,function(c){switch(c.label){case 0:t=this.heapArray.length,n=e,s=this.heapArray[e],r=2*e+1,c.label=1;case 1:return r<t?(o=r+1,l=o>=t,l?[3,3]:[4,this.compare(this.heapArray[r],this.heapArray[o])]):[3,5];case 2:l=c.sent()<0,c.label=3;case 3:return a=l?r:o,[4,this.compare(this.heapArray[a],s)];case 4:if(c.sent()<0)this.heapArray[e]=this.heapArray[a],e=a,r=2*e+1;else return[3,5];return[3,1];case 5:return e!==n&&(this.heapArray[e]=s),[2]}})})},i.prototype._sortNodeUp=function(e){return kt(this,void 0,void 0,function(){var t,n,s;return Lt(this,function(r){switch(r.label){case 0:t=this.heapArray[e],n=e,r.label=1;case 1:return e>0?(s=i.getParentIndexOf(e),[4,this.compare(t,this.heapArray[s])]):[3,3];case 2:if(r.sent()<0)this.heapArray[e]=this.heapArray[s],e=s;else return[3,3];return[3,1];case 3:return e!==n&&(this.heapArray[e]=t),[2]}})})},i.prototype._topN_push=function(e){return kt(this,void 0,void 0,function(){var t,n,s,r;return Lt(this,function(o){switch(o.label){case 0:t=new i(this._invertedCompare),t.limit=e,n=[0],s=this.heapArray,o.label=1;case 1:return n.length?(r=n.shift(),r<s.length?t.length<e?[4,t.push(s[r])]:[3,3]:[3,6]):[3,7];case 2:return o.sent(),n.push.apply(n,Fi([],wi(i.getChildrenIndexOf(r)),!1)),[3,6];case 3:return[4,this.compare(s[r],t.peek())];case 4:return o.sent()<0?[4,t.replace(s[r])]:[3,6];case 5:o.sent(),n.push.apply(n,Fi([],wi(i.getChildrenIndexOf(r)),!1)),o.label=6;case 6:return[3,1];case 7:return[2,t.toArray()]}})})},i.prototype._topN_fill=function(e){return kt(this,void 0,void 0,function(){var t,n,s,r,o,o;return Lt(this,function(a){switch(a.label){case 0:return t=this.heapArray,n=new i(this._invertedCompare),n.limit=e,n.heapArray=t.slice(0,e),[4,n.init()];case 1:for(a.sent(),s=i.getParentIndexOf(e-1)+1,r=[],o=s;o<e;++o)r.push.apply(r,Fi([],wi(i.getChildrenIndexOf(o).filter(function(l){return l<t.length})),!1));(e-1)%2&&r.push(e),a.label=2;case 2:return r.length?(o=r.shift(),o<t.length?[4,this.compare(t[o],n.peek())]:[3,5]):[3,6];case 3:return a.sent()<0?[4,n.replace(t[o])]:[3,5];case 4:a.sent(),r.push.apply(r,Fi([],wi(i.getChildrenIndexOf(o)),!1)),a.label=5;case 5:return[3,2];case 6:return[2,n.toArray()]}})})},i.prototype._topN_heap=function(e){return kt(this,void 0,void 0,function(){var t,n,s,r,o;return Lt(this,function(a){switch(a.label){case 0:t=this.clone(),n=[],s=0,a.label=1;case 1:return s<e?(o=(r=n).push,[4,t.pop()]):[3,4];case 2:o.apply(r,[a.sent()]),a.label=3;case 3:return++s,[3,1];case 4:return[2,n]}})})},i.prototype._topIdxOf=function(e){return kt(this,void 0,void 0,function(){var t,n,s,r;return Lt(this,function(o){switch(o.label){case 0:if(!e.length)return[2,-1];t=0,n=e[t],s=1,o.label=1;case 1:return s<e.length?[4,this.compare(e[s],n)]:[3,4];case 2:r=o.sent(),r<0&&(t=s,n=e[s]),o.label=3;case 3:return++s,[3,1];case 4:return[2,t]}})})},i.prototype._topOf=function(){for(var e=[],t=0;t<arguments.length;t++)e[t]=arguments[t];return kt(this,void 0,void 0,function(){var n;return Lt(this,function(s){switch(s.label){case 0:return n=new i(this.compare),[4,n.init(e)];case 1:return s.sent(),[2,n.peek()]}})})},i})(),Ev=function(i,e){var t={label:0,sent:function(){if(r[0]&1)throw r[1];return r[1]},trys:[],ops:[]},n,s,r,o=Object.create((typeof Iterator=="function"?Iterator:Object).prototype);return o.next=a(0),o.throw=a(1),o.return=a(2),typeof Symbol=="function"&&(o[Symbol.iterator]=function(){return this}),o;function a(c){return function(h){return l([c,h])}}function l(c){if(n)throw new TypeError("Generator is already executing.");for(;o&&(o=0,c[0]&&(t=0)),t;)try{if(n=1,s&&(r=c[0]&2?s.return:c[0]?s.throw||((r=s.return)&&r.call(s),0):s.next)&&!(r=r.call(s,c[1])).done)return r;switch(s=0,r&&(c=[c[0]&2,r.value]),c[0]){case 0:case 1:r=c;break;case 4:return t.label++,{value:c[1],done:!1};case 5:t.label++,s=c[1],c=[0];continue;case 7:c=t.ops.pop(),t.trys.pop();continue;default:if(r=t.trys,!(r=r.length>0&&r[r.length-1])&&(c[0]===6||c[0]===2)){t=0;continue}if(c[0]===3&&(!r||c[1]>r[0]&&c[1]<r[3])){t.label=c[1];break}if(c[0]===6&&t.label<r[1]){t.label=r[1],r=c;break}if(r&&t.label<r[2]){t.label=r[2],t.ops.push(c);break}r[2]&&t.ops.pop(),t.trys.pop();continue}c=e.call(i,t)}catch(h){c=[6,h],s=0}finally{n=r=0}if(c[0]&5)throw c[1];return{value:c[0]?c[1]:void 0,done:!0}}},Zn=function(i,e){var t=typeof Symbol=="function"&&i[Symbol.iterator];if(!t)return i;var n=t.call(i),s,r=[],o;try{for(;(e===void 0||e-- >0)&&!(s=n.next()).done;)r.push(s.value)}catch(a){o={error:a}}finally{try{s&&!s.done&&(t=n.return)&&t.call(n)}finally{if(o)throw o.error}}return r},li=function(i,e,t){if(t||arguments.length===2)for(var n=0,s=e.length,r;n<s;n++)(r||!(n in e))&&(r||(r=Array.prototype.slice.call(e,0,n)),r[n]=e[n]);return i.concat(r||Array.prototype.slice.call(e))};var Tv=(function(){function i(e){e===void 0&&(e=i.minComparator);var t=this;this.compare=e,this.heapArray=[],this._limit=0,this.offer=this.add,this.element=this.peek,this.poll=this.pop,this.removeAll=this.clear,this._invertedCompare=function(n,s){return-1*t.compare(n,s)}}return i.getChildrenIndexOf=function(e){return[e*2+1,e*2+2]},i.getParentIndexOf=function(e){return e<=0?-1:e-1>>1},i.getSiblingIndexOf=function(e){if(e<=0)return-1;var t=e%2?1:-1;return e+t},i.minComparator=function(e,t){return e>t?1:e<t?-1:0},i.maxComparator=function(e,t){return t>e?1:t<e?-1:0},i.minComparatorNumber=function(e,t){return e-t},i.maxComparatorNumber=function(e,t){return t-e},i.defaultIsEqual=function(e,t){return e===t},i.print=function(e){function t(h){var u=i.getParentIndexOf(h);return Math.floor(Math.log2(u+1))}function n(h,u){for(var f="";u>0;--u)f+=h;return f}for(var s=0,r=[],o=t(e.length-1)+2,a=0;s<e.length;){var l=t(s)+1;s===0&&(l=0);var c=String(e.get(s));c.length>a&&(a=c.length),r[l]=r[l]||[],r[l].push(c),s+=1}return r.map(function(h,u){var f=Math.pow(2,o-u)-1;return n(" ",Math.floor(f/2)*a)+h.map(function(p){var g=(a-p.length)/2;return n(" ",Math.ceil(g))+p+n(" ",Math.floor(g))}).join(n(" ",f*a))}).join(`
`)},i.heapify=function(e,t){var n=new i(t);return n.heapArray=e,n.init(),n},i.heappop=function(e,t){var n=new i(t);return n.heapArray=e,n.pop()},i.heappush=function(e,t,n){var s=new i(n);s.heapArray=e,s.push(t)},i.heappushpop=function(e,t,n){var s=new i(n);return s.heapArray=e,s.pushpop(t)},i.heapreplace=function(e,t,n){var s=new i(n);return s.heapArray=e,s.replace(t)},i.heaptop=function(e,t,n){t===void 0&&(t=1);var s=new i(n);return s.heapArray=e,s.top(t)},i.heapbottom=function(e,t,n){t===void 0&&(t=1);var s=new i(n);return s.heapArray=e,s.bottom(t)},i.nlargest=function(e,t,n){var s=new i(n);return s.heapArray=li([],Zn(t),!1),s.init(),s.top(e)},i.nsmallest=function(e,t,n){var s=new i(n);return s.heapArray=li([],Zn(t),!1),s.init(),s.bottom(e)},i.prototype.add=function(e){return this._sortNodeUp(this.heapArray.push(e)-1),this._applyLimit(),!0},i.prototype.addAll=function(e){var t,n=this.length;(t=this.heapArray).push.apply(t,li([],Zn(e),!1));for(var s=this.length;n<s;++n)this._sortNodeUp(n);return this._applyLimit(),!0},i.prototype.bottom=function(e){return e===void 0&&(e=1),this.heapArray.length===0||e<=0?[]:this.heapArray.length===1?[this.heapArray[0]]:e>=this.heapArray.length?li([],Zn(this.heapArray),!1):this._bottomN_push(~~e)},i.prototype.check=function(){var e=this;return this.heapArray.find(function(t,n){return!!e.getChildrenOf(n).find(function(s){return e.compare(t,s)>0})})},i.prototype.clear=function(){this.heapArray=[]},i.prototype.clone=function(){var e=new i(this.comparator());return e.heapArray=this.toArray(),e._limit=this._limit,e},i.prototype.comparator=function(){return this.compare},i.prototype.contains=function(e,t){return t===void 0&&(t=i.defaultIsEqual),this.indexOf(e,t)!==-1},i.prototype.init=function(e){e&&(this.heapArray=li([],Zn(e),!1));for(var t=i.getParentIndexOf(this.length-1);t>=0;--t)this._sortNodeDown(t);this._applyLimit()},i.prototype.isEmpty=function(){return this.length===0},i.prototype.indexOf=function(e,t){if(t===void 0&&(t=i.defaultIsEqual),this.heapArray.length===0)return-1;for(var n=[],s=0;s<this.heapArray.length;){var r=this.heapArray[s];if(t(r,e))return s;this.compare(r,e)<=0&&n.push.apply(n,li([],Zn(i.getChildrenIndexOf(s)),!1)),s=n.shift()||this.heapArray.length}return-1},i.prototype.indexOfEvery=function(e,t){if(t===void 0&&(t=i.defaultIsEqual),this.heapArray.length===0)return[];for(var n=[],s=[],r=0;r<this.heapArray.length;){var o=this.heapArray[r];t(o,e)?(s.push(r),n.push.apply(n,li([],Zn(i.getChildrenIndexOf(r)),!1))):this.compare(o,e)<=0&&n.push.apply(n,li([],Zn(i.getChildrenIndexOf(r)),!1)),r=n.shift()||this.heapArray.length}return s},i.prototype.leafs=function(){if(this.heapArray.length===0)return[];var e=i.getParentIndexOf(this.heapArray.length-1);return this.heapArray.slice(e+1)},Object.defineProperty(i.prototype,"length",{get:function(){return this.heapArray.length},enumerable:!1,configurable:!0}),Object.defineProperty(i.prototype,"limit",{get:function(){return this._limit},set:function(e){e<0||isNaN(e)?this._limit=0:this._limit=~~e,this._applyLimit()},enumerable:!1,configurable:!0}),i.prototype.setLimit=function(e){return this.limit=e,e<0||isNaN(e)?NaN:this._limit},i.prototype.peek=function(){return this.heapArray[0]},i.prototype.pop=function(){var e=this.heapArray.pop();return this.length>0&&e!==void 0?this.replace(e):e},i.prototype.push=function(){for(var e=[],t=0;t<arguments.length;t++)e[t]=arguments[t];return e.length<1?!1:e.length===1?this.add(e[0]):this.addAll(e)},i.prototype.pushpop=function(e){var t;return this.compare(this.heapArray[0],e)<0&&(t=Zn([this.heapArray[0],e],2),e=t[0],this.heapArray[0]=t[1],this._sortNodeDown(0)),e},i.prototype.remove=function(e,t){var n=this;if(t===void 0&&(t=i.defaultIsEqual),!this.heapArray.length)return!1;if(e===void 0)return this.pop(),!0;for(var s=[0];s.length;){var r=s.shift();if(t(this.heapArray[r],e))return r===0?this.pop():r===this.heapArray.length-1?this.heapArray.pop():(this.heapArray.splice(r,1,this.heapArray.pop()),this._sortNodeUp(r),this._sortNodeDown(r)),!0;if(this.compare(this.heapArray[r],e)<=0){var o=i.getChildrenIndexOf(r).filter(function(a){return a<n.heapArray.length});s.push.apply(s,li([],Zn(o),!1))}}return!1},i.prototype.replace=function(e){var t=this.heapArray[0];return this.heapArray[0]=e,this._sortNodeDown(0),t},i.prototype.size=function(){return this.length},i.prototype.top=function(e){return e===void 0&&(e=1),this.heapArray.length===0||e<=0?[]:this.heapArray.length===1||e===1?[this.heapArray[0]]:e>=this.heapArray.length?li([],Zn(this.heapArray),!1):this._topN_push(~~e)},i.prototype.toArray=function(){return li([],Zn(this.heapArray),!1)},i.prototype.toString=function(){return this.heapArray.toString()},i.prototype.get=function(e){return this.heapArray[e]},i.prototype.getChildrenOf=function(e){var t=this;return i.getChildrenIndexOf(e).map(function(n){return t.heapArray[n]}).filter(function(n){return n!==void 0})},i.prototype.getParentOf=function(e){var t=i.getParentIndexOf(e);return this.heapArray[t]},i.prototype[Symbol.iterator]=function(){return Ev(this,function(e){switch(e.label){case 0:return this.length?[4,this.pop()]:[3,2];case 1:return e.sent(),[3,0];case 2:return[2]}})},i.prototype.iterator=function(){return this.toArray()},i.prototype._applyLimit=function(){if(this._limit>0&&this._limit<this.heapArray.length)for(var e=this.heapArray.length-this._limit;e;)this.heapArray.pop(),--e},i.prototype._bottomN_push=function(e){var t=new i(this.compare);t.limit=e,t.heapArray=this.heapArray.slice(-e),t.init();for(var n=this.heapArray.length-1-e,s=i.getParentIndexOf(n),r=[],o=n;o>s;--o)r.push(o);for(var a=this.heapArray;r.length;){var o=r.shift();this.compare(a[o],t.peek())>0&&(t.replace(a[o]),o%2&&r.push(i.getParentIndexOf(o)))}return t.toArray()},i.prototype._moveNode=function(e,t){var n=this.heapArray[e];this.heapArray[e]=this.heapArray[t],this.heapArray[t]=n},i.prototype._sortNodeDown=function(e){for(var t=this.heapArray.length,n=e,s=this.heapArray[e],r=2*e+1;r<t;){var o=r+1,a=o>=t||this.compare(this.heapArray[r],this.heapArray[o])<0?r:o;if(this.compare(this.heapArray[a],s)<0)this.heapArray[e]=this.heapArray[a],e=a,r=2*e+1;else break}e!==n&&(this.heapArray[e]=s)},i.prototype._sortNodeUp=function(e){for(var t=this.heapArray[e],n=e;e>0;){var s=i.getParentIndexOf(e);if(this.compare(t,this.heapArray[s])<0)this.heapArray[e]=this.heapArray[s],e=s;else break}e!==n&&(this.heapArray[e]=t)},i.prototype._topN_push=function(e){var t=new i(this._invertedCompare);t.limit=e;for(var n=[0],s=this.heapArray;n.length;){var r=n.shift();r<s.length&&(t.length<e?(t.push(s[r]),n.push.apply(n,li([],Zn(i.getChildrenIndexOf(r)),!1))):this.compare(s[r],t.peek())<0&&(t.replace(s[r]),n.push.apply(n,li([],Zn(i.getChildrenIndexOf(r)),!1))))}return t.toArray()},i.prototype._topN_fill=function(e){var t=this.heapArray,n=new i(this._invertedCompare);n.limit=e,n.heapArray=t.slice(0,e),n.init();for(var s=i.getParentIndexOf(e-1)+1,r=[],o=s;o<e;++o)r.push.apply(r,li([],Zn(i.getChildrenIndexOf(o).filter(function(a){return a<t.length})),!1));for((e-1)%2&&r.push(e);r.length;){var o=r.shift();o<t.length&&this.compare(t[o],n.peek())<0&&(n.replace(t[o]),r.push.apply(r,li([],Zn(i.getChildrenIndexOf(o)),!1)))}return n.toArray()},i.prototype._topN_heap=function(e){for(var t=this.clone(),n=[],s=0;s<e;++s)n.push(t.pop());return n},i.prototype._topIdxOf=function(e){if(!e.length)return-1;for(var t=0,n=e[t],s=1;s<e.length;++s){var r=this.compare(e[s],n);r<0&&(t=s,n=e[s])}return t},i.prototype._topOf=function(){for(var e=[],t=0;t<arguments.length;t++)e[t]=arguments[t];var n=new i(this.compare);return n.init(e),n.peek()},i})();var sg=typeof DataView.prototype.getBigUint64=="function"?DataView.prototype.getBigUint64:function(i,e){let t=e===!0?this.getUint32(i,e):this.getUint32(i+4,e),n=e===!0?this.getUint32(i+4,e):this.getUint32(i,e);return BigInt(n)<<32n|BigInt(t)};var Cv=new TextDecoder,qs=class{#t;#e;offset;constructor(e,t=0){this.#t=e,this.#e=new Uint8Array(e.buffer,e.byteOffset,e.byteLength),this.offset=t}reset(e,t=0){this.#t=e,this.#e=new Uint8Array(e.buffer,e.byteOffset,e.byteLength),this.offset=t}bytesRemaining(){return this.#e.length-this.offset}uint8(){let e=this.#t.getUint8(this.offset);return this.offset+=1,e}uint16(){let e=this.#t.getUint16(this.offset,!0);return this.offset+=2,e}uint32(){let e=this.#t.getUint32(this.offset,!0);return this.offset+=4,e}uint64(){let e=sg.call(this.#t,this.offset,!0);return this.offset+=8,e}string(){let e=this.uint32();if(e===0)return"";if(e>this.bytesRemaining())throw new Error(`String length ${e} exceeds bounds of buffer`);return Cv.decode(this.u8ArrayBorrow(e))}keyValuePairs(e,t){let n=this.uint32();if(this.offset+n>this.#t.byteLength)throw new Error(`Key-value pairs length ${n} exceeds bounds of buffer`);let s=[],r=this.offset+n;try{for(;this.offset<r;)s.push([e(this),t(this)])}catch(o){throw new Error(`Error reading key-value pairs: ${o.message}`)}if(this.offset!==r)throw new Error(`Key-value pairs length (${this.offset-r+n}) greater than expected (${n})`);return s}map(e,t){let n=this.uint32();if(this.offset+n>this.#t.byteLength)throw new Error(`Map length ${n} exceeds bounds of buffer`);let s=new Map,r=this.offset+n;try{for(;this.offset<r;){let o=e(this),a=t(this),l=s.get(o);if(l!=null)throw new Error(`Duplicate key ${String(o)} (${String(l)} vs ${String(a)})`);s.set(o,a)}}catch(o){throw new Error(`Error reading map: ${o.message}`)}if(this.offset!==r)throw new Error(`Map length (${this.offset-r+n}) greater than expected (${n})`);return s}u8ArrayBorrow(e){let t=this.#e.subarray(this.offset,this.offset+e);return this.offset+=e,t}u8ArrayCopy(e){let t=this.#e.slice(this.offset,this.offset+e);return this.offset+=e,t}};var hs=Object.freeze([137,77,67,65,80,48,13,10]),Sn;(function(i){i[i.MIN=1]="MIN",i[i.HEADER=1]="HEADER",i[i.FOOTER=2]="FOOTER",i[i.SCHEMA=3]="SCHEMA",i[i.CHANNEL=4]="CHANNEL",i[i.MESSAGE=5]="MESSAGE",i[i.CHUNK=6]="CHUNK",i[i.MESSAGE_INDEX=7]="MESSAGE_INDEX",i[i.CHUNK_INDEX=8]="CHUNK_INDEX",i[i.ATTACHMENT=9]="ATTACHMENT",i[i.ATTACHMENT_INDEX=10]="ATTACHMENT_INDEX",i[i.STATISTICS=11]="STATISTICS",i[i.METADATA=12]="METADATA",i[i.METADATA_INDEX=13]="METADATA_INDEX",i[i.SUMMARY_OFFSET=14]="SUMMARY_OFFSET",i[i.DATA_END=15]="DATA_END",i[i.MAX=15]="MAX"})(Sn||(Sn={}));function Bl(i){if(i.bytesRemaining()<hs.length)return;let e=i.u8ArrayBorrow(hs.length);if(!hs.every((t,n)=>t===e[n]))throw new Error(`Expected MCAP magic '${hs.map(t=>t.toString(16).padStart(2,"0")).join(" ")}', found '${Array.from(e,(t,n)=>e[n].toString(16).padStart(2,"0")).join(" ")}'`);return{specVersion:"0"}}function ya(i,e=!1){if(i.bytesRemaining()<9)return;let n=i.offset,s=i.uint8(),r=i.uint64();if(r>Number.MAX_SAFE_INTEGER)throw new Error(`Record content length ${r} is too large`);let o=Number(r);if(i.bytesRemaining()<o){i.offset=n;return}let a;switch(s){case Sn.HEADER:a=Pv(i,o);break;case Sn.FOOTER:a=Lv(i,o);break;case Sn.SCHEMA:a=Dv(i,o);break;case Sn.CHANNEL:a=Nv(i,o);break;case Sn.MESSAGE:a=Uv(i,o);break;case Sn.CHUNK:a=Fv(i,o);break;case Sn.MESSAGE_INDEX:a=Ov(i,o);break;case Sn.CHUNK_INDEX:a=kv(i,o);break;case Sn.ATTACHMENT:a=Bv(i,o,e);break;case Sn.ATTACHMENT_INDEX:a=zv(i,o);break;case Sn.STATISTICS:a=Vv(i,o);break;case Sn.METADATA:a=Hv(i,o);break;case Sn.METADATA_INDEX:a=Gv(i,o);break;case Sn.SUMMARY_OFFSET:a=Wv(i,o);break;case Sn.DATA_END:a=Xv(i,o);break;default:a=Iv(i,o,s);break}return i.offset=n+9+o,a}function Iv(i,e,t){let n=i.u8ArrayBorrow(e);return{type:"Unknown",opcode:t,data:n}}function Pv(i,e){let t=i.offset,n=i.string(),s=i.string();return i.offset=t+e,{type:"Header",profile:n,library:s}}function Lv(i,e){let t=i.offset,n=i.uint64(),s=i.uint64(),r=i.uint32();return i.offset=t+e,{type:"Footer",summaryStart:n,summaryOffsetStart:s,summaryCrc:r}}function Dv(i,e){let t=i.offset,n=i.uint16(),s=i.string(),r=i.string(),o=i.uint32(),a=i.offset;if(e-(a-t)<o)throw new Error(`Schema data length ${o} exceeds bounds of record`);let l=i.u8ArrayCopy(o);return i.offset=t+e,{type:"Schema",id:n,encoding:r,name:s,data:l}}function Nv(i,e){let t=i.offset,n=i.uint16(),s=i.uint16(),r=i.string(),o=i.string(),a=i.map(l=>l.string(),l=>l.string());return i.offset=t+e,{type:"Channel",id:n,schemaId:s,topic:r,messageEncoding:o,metadata:a}}function Uv(i,e){let n=i.uint16(),s=i.uint32(),r=i.uint64(),o=i.uint64(),a=i.u8ArrayCopy(e-22);return{type:"Message",channelId:n,sequence:s,logTime:r,publishTime:o,data:a}}function Fv(i,e){let t=i.offset,n=i.uint64(),s=i.uint64(),r=i.uint64(),o=i.uint32(),a=i.string(),l=Number(i.uint64()),h=i.offset-t;if(l+h>e)throw new Error("Chunk records length exceeds remaining record size");let u=i.u8ArrayCopy(l);return i.offset=t+e,{type:"Chunk",messageStartTime:n,messageEndTime:s,compression:a,uncompressedSize:r,uncompressedCrc:o,records:u}}function Ov(i,e){let t=i.offset,n=i.uint16(),s=i.keyValuePairs(r=>r.uint64(),r=>r.uint64());return i.offset=t+e,{type:"MessageIndex",channelId:n,records:s}}function kv(i,e){let t=i.offset,n=i.uint64(),s=i.uint64(),r=i.uint64(),o=i.uint64(),a=i.map(f=>f.uint16(),f=>f.uint64()),l=i.uint64(),c=i.string(),h=i.uint64(),u=i.uint64();return i.offset=t+e,{type:"ChunkIndex",messageStartTime:n,messageEndTime:s,chunkStartOffset:r,chunkLength:o,messageIndexOffsets:a,messageIndexLength:l,compression:c,compressedSize:h,uncompressedSize:u}}function Bv(i,e,t){let n=i.offset,s=i.uint64(),r=i.uint64(),o=i.string(),a=i.string(),l=i.uint64();if(BigInt(i.offset)+l>Number.MAX_SAFE_INTEGER)throw new Error(`Attachment too large: ${l}`);if(i.offset+Number(l)+4>n+e)throw new Error(`Attachment data length ${l} exceeds bounds of record`);let c=i.u8ArrayCopy(Number(l)),h=i.offset-n,u=i.uint32();if(t&&u!==0){i.offset=n;let f=i.u8ArrayBorrow(h),p=Mr(f);if(i.offset=n+h+4,p!==u)throw new Error(`Attachment CRC32 mismatch: expected ${u}, actual ${p}`)}return i.offset=n+e,{type:"Attachment",logTime:s,createTime:r,name:o,mediaType:a,data:c}}function zv(i,e){let t=i.offset,n=i.uint64(),s=i.uint64(),r=i.uint64(),o=i.uint64(),a=i.uint64(),l=i.string(),c=i.string();return i.offset=t+e,{type:"AttachmentIndex",offset:n,length:s,logTime:r,createTime:o,dataSize:a,name:l,mediaType:c}}function Vv(i,e){let t=i.offset,n=i.uint64(),s=i.uint16(),r=i.uint32(),o=i.uint32(),a=i.uint32(),l=i.uint32(),c=i.uint64(),h=i.uint64(),u=i.map(f=>f.uint16(),f=>f.uint64());return i.offset=t+e,{type:"Statistics",messageCount:n,schemaCount:s,channelCount:r,attachmentCount:o,metadataCount:a,chunkCount:l,messageStartTime:c,messageEndTime:h,channelMessageCounts:u}}function Hv(i,e){let t=i.offset,n=i.string(),s=i.map(r=>r.string(),r=>r.string());return i.offset=t+e,{type:"Metadata",metadata:s,name:n}}function Gv(i,e){let t=i.offset,n=i.uint64(),s=i.uint64(),r=i.string();return i.offset=t+e,{type:"MetadataIndex",offset:n,length:s,name:r}}function Wv(i,e){let t=i.offset,n=i.uint8(),s=i.uint64(),r=i.uint64();return i.offset=t+e,{type:"SummaryOffset",groupOpcode:n,groupStart:s,groupLength:r}}function Xv(i,e){let t=i.offset,n=i.uint32();return i.offset=t+e,{type:"DataEnd",dataSectionCrc:n}}var mo=class{#t=new ArrayBuffer(hs.length*2);#e=new DataView(this.#t,0,0);#n=new qs(this.#e);#o;#a;#i;#l;#s=!1;#c=this.#u();#r=new Map;constructor({includeChunks:e=!1,decompressHandlers:t={},validateCrcs:n=!0,noMagicPrefix:s=!1}={}){this.#a=e,this.#o=t,this.#i=n,this.#l=s}done(){return this.#s}bytesRemaining(){return this.#n.bytesRemaining()}append(e){if(this.#s)throw new Error("Already done reading");this.#h(e)}#h(e){let t=this.#n.offset,n=this.#e.byteLength-t,s=n+e.byteLength;if(s<=this.#t.byteLength)if(this.#e.byteOffset+this.#e.byteLength+e.byteLength<=this.#t.byteLength)new Uint8Array(this.#t,this.#e.byteOffset).set(e,this.#e.byteLength),this.#e=new DataView(this.#t,this.#e.byteOffset,this.#e.byteLength+e.byteLength),this.#n.reset(this.#e,this.#n.offset);else{let r=new Uint8Array(this.#t,this.#e.byteOffset+t,n),o=new Uint8Array(this.#t);o.set(r,0),o.set(e,r.byteLength),this.#e=new DataView(this.#t,0,r.byteLength+e.byteLength),this.#n.reset(this.#e)}else{this.#t=new ArrayBuffer(s*2);let r=new Uint8Array(this.#t),o=new Uint8Array(this.#e.buffer,this.#e.byteOffset+t,n);r.set(o,0),r.set(e,o.byteLength),this.#e=new DataView(this.#t,0,o.byteLength+e.byteLength),this.#n.reset(this.#e)}}nextRecord(){if(this.#s)return;let e=this.#c.next();if(e.value?.type==="Channel"){let t=this.#r.get(e.value.id);if(this.#r.set(e.value.id,e.value),t&&!$v(t,e.value))throw new Error(`Channel record for id ${e.value.id} (topic: ${e.value.topic}) differs from previous channel record of the same id.`)}else if(e.value?.type==="Message"){let t=e.value.channelId;if(!this.#r.get(t))throw new Error(`Encountered message on channel ${t} without prior channel record`)}return e.done===!0&&(this.#s=!0),e.value}*#u(){if(!this.#l){let n;for(;n=Bl(this.#n),!n;)yield}let e;function t(n){return new Error(`${n} ${e?`[library=${e.library}]`:"[no header]"}`)}for(;;){let n;for(;n=ya(this.#n,this.#i),!n;)yield;switch(n.type){case"Header":if(e)throw new Error(`Duplicate Header record: library=${e.library} profile=${e.profile} vs. library=${n.library} profile=${n.profile}`);e=n,yield n;break;case"Unknown":case"Schema":case"Channel":case"Message":case"MessageIndex":case"ChunkIndex":case"Attachment":case"AttachmentIndex":case"Statistics":case"Metadata":case"MetadataIndex":case"SummaryOffset":case"DataEnd":yield n;break;case"Chunk":{this.#a&&(yield n);let s=n.records;if(n.compression!==""&&s.byteLength>0){let l=this.#o[n.compression];if(!l)throw t(`Unsupported compression ${n.compression}`);s=l(s,n.uncompressedSize)}if(this.#i&&n.uncompressedCrc!==0){let l=Mr(s);if(l!==n.uncompressedCrc)throw t(`Incorrect chunk CRC ${l} (expected ${n.uncompressedCrc})`)}let r=new DataView(s.buffer,s.byteOffset,s.byteLength),o=new qs(r),a;for(;a=ya(o,this.#i);)switch(a.type){case"Header":case"Footer":case"Chunk":case"MessageIndex":case"ChunkIndex":case"Attachment":case"AttachmentIndex":case"Statistics":case"Metadata":case"MetadataIndex":case"SummaryOffset":case"DataEnd":throw t(`${a.type} record not allowed inside a chunk`);case"Unknown":case"Schema":case"Channel":case"Message":yield a;break}if(o.bytesRemaining()!==0)throw t(`${o.bytesRemaining()} bytes remaining in chunk`);break}case"Footer":try{let s;for(;s=Bl(this.#n),!s;)yield}catch(s){throw t(s.message)}if(this.#n.bytesRemaining()!==0)throw t(`${this.#n.bytesRemaining()} bytes remaining after MCAP footer and trailing magic`);return n}}}};function $v(i,e){if(!(i.id===e.id&&i.messageEncoding===e.messageEncoding&&i.schemaId===e.schemaId&&i.topic===e.topic&&i.metadata.size===e.metadata.size))return!1;for(let[t,n]of i.metadata.entries()){let s=e.metadata.get(t);if(n!==s)return!1}return!0}var qv="2.2.2",Yv=`mcap-typescript/${qv}`;var Jv=ArrayBuffer,mn=Uint8Array,zl=Uint16Array,jv=Int16Array;var Vl=Int32Array,of=function(i,e,t){if(mn.prototype.slice)return mn.prototype.slice.call(i,e,t);(e==null||e<0)&&(e=0),(t==null||t>i.length)&&(t=i.length);var n=new mn(t-e);return n.set(i.subarray(e,t)),n},xa=function(i,e,t,n){if(mn.prototype.fill)return mn.prototype.fill.call(i,e,t,n);for((t==null||t<0)&&(t=0),(n==null||n>i.length)&&(n=i.length);t<n;++t)i[t]=e;return i},Qv=function(i,e,t,n){if(mn.prototype.copyWithin)return mn.prototype.copyWithin.call(i,e,t,n);for((t==null||t<0)&&(t=0),(n==null||n>i.length)&&(n=i.length);t<n;)i[e++]=i[t++]};var eb=["invalid zstd data","window size too large (>2046MB)","invalid block type","FSE accuracy too high","match distance too far back","unexpected EOF"],wn=function(i,e,t){var n=new Error(e||eb[i]);if(n.code=i,Error.captureStackTrace&&Error.captureStackTrace(n,wn),!t)throw n;return n},og=function(i,e,t){for(var n=0,s=0;n<t;++n)s|=i[e++]<<(n<<3);return s},tb=function(i,e){return(i[e]|i[e+1]<<8|i[e+2]<<16|i[e+3]<<24)>>>0},nb=function(i,e){var t=i[0]|i[1]<<8|i[2]<<16;if(t==3126568&&i[3]==253){var n=i[4],s=n>>5&1,r=n>>2&1,o=n&3,a=n>>6;n&8&&wn(0);var l=6-s,c=o==3?4:o,h=og(i,l,c);l+=c;var u=a?1<<a:s,f=og(i,l,u)+(a==1&&256),p=f;if(!s){var g=1<<10+(i[5]>>3);p=g+(g>>3)*(i[5]&7)}p>2145386496&&wn(1);var x=new mn((e==1?f||p:e?0:p)+12);return x[0]=1,x[4]=4,x[8]=8,{b:l+u,y:0,l:0,d:h,w:e&&e!=1?e:x.subarray(12),e:p,o:new Vl(x.buffer,0,3),u:f,c:r,m:Math.min(131072,p)}}else if((t>>4|i[3]<<20)==25481893)return tb(i,4)+8;wn(0)},Sr=function(i){for(var e=0;1<<e<=i;++e);return e-1},va=function(i,e,t){var n=(e<<3)+4,s=(i[e]&15)+5;s>t&&wn(3);for(var r=1<<s,o=r,a=-1,l=-1,c=-1,h=r,u=new Jv(512+(r<<2)),f=new jv(u,0,256),p=new zl(u,0,256),g=new zl(u,512,r),x=512+(r<<1),m=new mn(u,x,r),d=new mn(u,x+r);a<255&&o>0;){var y=Sr(o+1),w=n>>3,v=(1<<y+1)-1,E=(i[w]|i[w+1]<<8|i[w+2]<<16)>>(n&7)&v,S=(1<<y)-1,_=v-o-1,M=E&S;if(M<_?(n+=y,E=M):(n+=y+1,E>S&&(E-=_)),f[++a]=--E,E==-1?(o+=E,m[--h]=a):o-=E,!E)do{var D=n>>3;l=(i[D]|i[D+1]<<8)>>(n&7)&3,n+=2,a+=l}while(l==3)}(a>255||o)&&wn(0);for(var I=0,L=(r>>1)+(r>>3)+3,k=r-1,V=0;V<=a;++V){var R=f[V];if(R<1){p[V]=-R;continue}for(c=0;c<R;++c){m[I]=V;do I=I+L&k;while(I>=h)}}for(I&&wn(0),c=0;c<r;++c){var U=p[m[c]]++,X=d[c]=s-Sr(U);g[c]=(U<<X)-r}return[n+7>>3,{b:s,s:m,n:d,t:g}]},ib=function(i,e){var t=0,n=-1,s=new mn(292),r=i[e],o=s.subarray(0,256),a=s.subarray(256,268),l=new zl(s.buffer,268);if(r<128){var c=va(i,e+1,6),h=c[0],u=c[1];e+=r;var f=h<<3,p=i[e];p||wn(0);for(var g=0,x=0,m=u.b,d=m,y=(++e<<3)-8+Sr(p);y-=m,!(y<f);){var w=y>>3;if(g+=(i[w]|i[w+1]<<8)>>(y&7)&(1<<m)-1,o[++n]=u.s[g],y-=d,y<f)break;w=y>>3,x+=(i[w]|i[w+1]<<8)>>(y&7)&(1<<d)-1,o[++n]=u.s[x],m=u.n[g],g=u.t[g],d=u.n[x],x=u.t[x]}++n>255&&wn(0)}else{for(n=r-127;t<n;t+=2){var v=i[++e];o[t]=v>>4,o[t+1]=v&15}++e}var E=0;for(t=0;t<n;++t){var S=o[t];S>11&&wn(0),E+=S&&1<<S-1}var _=Sr(E)+1,M=1<<_,D=M-E;for(D&D-1&&wn(0),o[n++]=Sr(D)+1,t=0;t<n;++t){var S=o[t];++a[o[t]=S&&_+1-S]}var I=new mn(M<<1),L=I.subarray(0,M),k=I.subarray(M);for(l[_]=0,t=_;t>0;--t){var V=l[t];xa(k,t,V,l[t-1]=V+a[t]*(1<<_-t))}for(l[0]!=M&&wn(0),t=0;t<n;++t){var R=o[t];if(R){var U=l[R];xa(L,t,U,l[R]=U+(1<<_-R))}}return[e,{n:k,b:_,s:L}]},sb=va(new mn([81,16,99,140,49,198,24,99,12,33,196,24,99,102,102,134,70,146,4]),0,6)[1],rb=va(new mn([33,20,196,24,99,140,33,132,16,66,8,33,132,16,66,8,33,68,68,68,68,68,68,68,68,36,9]),0,6)[1],ob=va(new mn([32,132,16,66,102,70,68,68,68,68,36,73,2]),0,5)[1],ag=function(i,e){for(var t=i.length,n=new Vl(t),s=0;s<t;++s)n[s]=e,e+=1<<i[s];return n},af=new mn(new Vl([0,0,0,0,16843009,50528770,134678020,202050057,269422093]).buffer,0,36),ab=ag(af,0),lf=new mn(new Vl([0,0,0,0,0,0,0,0,16843009,50528770,117769220,185207048,252579084,16]).buffer,0,53),lb=ag(lf,3),_a=function(i,e,t){var n=i.length,s=e.length,r=i[n-1],o=(1<<t.b)-1,a=-t.b;r||wn(0);for(var l=0,c=t.b,h=(n<<3)-8+Sr(r)-c,u=-1;h>a&&u<s;){var f=h>>3,p=(i[f]|i[f+1]<<8|i[f+2]<<16)>>(h&7);l=(l<<c|p)&o,e[++u]=t.s[l],h-=c=t.n[l]}(h!=a||u+1!=s)&&wn(0)},cb=function(i,e,t){var n=6,s=e.length,r=s+3>>2,o=r<<1,a=r+o;_a(i.subarray(n,n+=i[0]|i[1]<<8),e.subarray(0,r),t),_a(i.subarray(n,n+=i[2]|i[3]<<8),e.subarray(r,o),t),_a(i.subarray(n,n+=i[4]|i[5]<<8),e.subarray(o,a),t),_a(i.subarray(n),e.subarray(a),t)},hb=function(i,e,t){var n,s=e.b,r=i[s],o=r>>1&3;e.l=r&1;var a=r>>3|i[s+1]<<5|i[s+2]<<13,l=(s+=3)+a;if(o==1)return s>=i.length?void 0:(e.b=s+1,t?(xa(t,i[s],e.y,e.y+=a),t):xa(new mn(a),i[s]));if(!(l>i.length)){if(o==0)return e.b=l,t?(t.set(i.subarray(s,l),e.y),e.y+=a,t):of(i,s,l);if(o==2){var c=i[s],h=c&3,u=c>>2&3,f=c>>4,p=0,g=0;h<2?u&1?f|=i[++s]<<4|(u&2&&i[++s]<<12):f=c>>3:(g=u,u<2?(f|=(i[++s]&63)<<4,p=i[s]>>6|i[++s]<<2):u==2?(f|=i[++s]<<4|(i[++s]&3)<<12,p=i[s]>>2|i[++s]<<6):(f|=i[++s]<<4|(i[++s]&63)<<12,p=i[s]>>6|i[++s]<<2|i[++s]<<10)),++s;var x=t?t.subarray(e.y,e.y+e.m):new mn(e.m),m=x.length-f;if(h==0)x.set(i.subarray(s,s+=f),m);else if(h==1)xa(x,i[s++],m);else{var d=e.h;if(h==2){var y=ib(i,s);p+=s-(s=y[0]),e.h=d=y[1]}else d||wn(0);(g?cb:_a)(i.subarray(s,s+=p),x.subarray(m),d)}var w=i[s++];if(w){w==255?w=(i[s++]|i[s++]<<8)+32512:w>127&&(w=w-128<<8|i[s++]);var v=i[s++];v&3&&wn(0);for(var E=[rb,ob,sb],S=2;S>-1;--S){var _=v>>(S<<1)+2&3;if(_==1){var M=new mn([0,0,i[s++]]);E[S]={s:M.subarray(2,3),n:M.subarray(0,1),t:new zl(M.buffer,0,1),b:0}}else _==2?(n=va(i,s,9-(S&1)),s=n[0],E[S]=n[1]):_==3&&(e.t||wn(0),E[S]=e.t[S])}var D=e.t=E,I=D[0],L=D[1],k=D[2],V=i[l-1];V||wn(0);var R=(l<<3)-8+Sr(V)-k.b,U=R>>3,X=0,H=(i[U]|i[U+1]<<8)>>(R&7)&(1<<k.b)-1;U=(R-=L.b)>>3;var ae=(i[U]|i[U+1]<<8)>>(R&7)&(1<<L.b)-1;U=(R-=I.b)>>3;var Y=(i[U]|i[U+1]<<8)>>(R&7)&(1<<I.b)-1;for(++w;--w;){var J=k.s[H],ee=k.n[H],fe=I.s[Y],ue=I.n[Y],Q=L.s[ae],me=L.n[ae];U=(R-=Q)>>3;var ge=1<<Q,_e=ge+((i[U]|i[U+1]<<8|i[U+2]<<16|i[U+3]<<24)>>>(R&7)&ge-1);U=(R-=lf[fe])>>3;var ye=lb[fe]+((i[U]|i[U+1]<<8|i[U+2]<<16)>>(R&7)&(1<<lf[fe])-1);U=(R-=af[J])>>3;var He=ab[J]+((i[U]|i[U+1]<<8|i[U+2]<<16)>>(R&7)&(1<<af[J])-1);if(U=(R-=ee)>>3,H=k.t[H]+((i[U]|i[U+1]<<8)>>(R&7)&(1<<ee)-1),U=(R-=ue)>>3,Y=I.t[Y]+((i[U]|i[U+1]<<8)>>(R&7)&(1<<ue)-1),U=(R-=me)>>3,ae=L.t[ae]+((i[U]|i[U+1]<<8)>>(R&7)&(1<<me)-1),_e>3)e.o[2]=e.o[1],e.o[1]=e.o[0],e.o[0]=_e-=3;else{var Ke=_e-(He!=0);Ke?(_e=Ke==3?e.o[0]-1:e.o[Ke],Ke>1&&(e.o[2]=e.o[1]),e.o[1]=e.o[0],e.o[0]=_e):_e=e.o[0]}for(var S=0;S<He;++S)x[X+S]=x[m+S];X+=He,m+=He;var Oe=X-_e;if(Oe<0){var it=-Oe,at=e.e+Oe;it>ye&&(it=ye);for(var S=0;S<it;++S)x[X+S]=e.w[at+S];X+=it,ye-=it,Oe=0}for(var S=0;S<ye;++S)x[X+S]=x[Oe+S];X+=ye}if(X!=m)for(;m<x.length;)x[X++]=x[m++];else X=x.length;t?e.y+=X:x=of(x,0,X)}else if(t){if(e.y+=f,m)for(var S=0;S<f;++S)x[S]=x[m+S]}else m&&(x=of(x,m));return e.b=l,x}wn(2)}},ub=function(i,e){if(i.length==1)return i[0];for(var t=new mn(e),n=0,s=0;n<i.length;++n){var r=i[n];t.set(r,s),s+=r.length}return t};function lg(i,e){for(var t=[],n=+!e,s=0,r=0;i.length;){var o=nb(i,n||e);if(typeof o=="object"){for(n?(e=null,o.w.length==o.u&&(t.push(e=o.w),r+=o.u)):(t.push(e),o.e=0);!o.l;){var a=hb(i,o,e);a||wn(5),e?o.e=o.y:(t.push(a),r+=a.length,Qv(o.w,0,a.length),o.w.set(a,o.w.length-a.length))}s=o.b+o.c*4}else s=o;i=i.subarray(s)}return ub(t,r)}var cg={bool:1,byte:1,char:1,int8:1,uint8:1,int16:2,uint16:2,int32:4,uint32:4,int64:8,uint64:8,float32:4,float64:8},Hl=class{places=new Map;size;constructor(e){let t=e.split(/^=+$/m),n=new Map;for(let s of t.slice(1)){let r=/^\s*MSG:\s*(\S+)\s*$/m.exec(s);r&&n.set(r[1],s.slice(s.indexOf(r[0])+r[0].length))}this.size=this.walk(t[0],n,"",0,0)}walk(e,t,n,s,r){if(r>8)throw new Error("a schema that contains itself");for(let o of e.split(`
`)){let a=o.replace(/#.*/,"").trim();if(a===""||a.includes("="))continue;let l=/^([A-Za-z0-9_/]+)(?:\[(\d+)\])?\s+(\w+)$/.exec(a);if(!l)throw new Error(`a schema with the line "${a}", which this page does not read`);let[,c,h,u]=l,f=cg[c];if(f){s+=(f-s%f)%f,this.places.set(n+u,{offset:s,type:c,count:h?Number(h):1}),s+=f*(h?Number(h):1);continue}let p=t.get(c)??[...t].find(([g])=>g.endsWith("/"+c))?.[1];if(p===void 0||h)throw new Error(`a schema with the type ${c}, which this page does not read`);s=this.walk(p,t,`${n}${u}.`,s,r+1)}return s}reader(e,t=0){let n=this.places.get(e);if(!n||t>=n.count)throw new Error(`a report without ${e}`);let s=4+n.offset+t*cg[n.type];switch(n.type){case"float64":return r=>r.getFloat64(s,!0);case"float32":return r=>r.getFloat32(s,!0);case"int64":return r=>Number(r.getBigInt64(s,!0));case"uint64":return r=>Number(r.getBigUint64(s,!0));case"uint32":return r=>r.getUint32(s,!0);case"int32":return r=>r.getInt32(s,!0);default:return r=>r.getUint8(s)}}};var wr=16,cf=1<<20,hg=2e7,fb=/^\/\w+\/report$/;function db(i,e){let t=new DataView(e.buffer,e.byteOffset,e.byteLength);if(e.byteLength<16)throw new Error("a mesh that is shorter than its head");i.set(`${t.getBigUint64(0,!0)}/${t.getUint32(8,!0)}`,e.slice(16).buffer)}async function ug(i,e){let t=[137,77,67,65,80,48,13,10];if(i.length<8||t.some((R,U)=>i[U]!==R))throw new Error("no MCAP file; open one that knurl record made");let n=new mo({decompressHandlers:{zstd:(R,U)=>lg(R,new Uint8Array(Number(U)))},validateCrcs:!1}),s=new Map,r=new Map,o=[],a=[],l=new Map,c=()=>Number(s.get("realtime_offset_ns")??0),h=-1,u=-1,f=-1,p=null,g=[],x=[],m=R=>0,d=m,y=m,w=0,v=0,E=[],S=13+wr,_={t:new Float64Array(4096),rows:new Float32Array(4096*S)},M=0,D=R=>{if(!p)return;if(R.byteLength!==p.size+4)throw new Error("a message has the wrong length: the file was changed");let U=new DataView(R.buffer,R.byteOffset,R.byteLength),X=m(U);v===0&&(w=X),M===4096&&(E.push(_),_={t:new Float64Array(4096),rows:new Float32Array(4096*S)},M=0),_.t[M]=(X-w)*1e-9;let H=M*S;for(let ee=0;ee<9;ee++)_.rows[H+ee]=g[ee](U);_.rows[H+9]=(X-d(U))*.001,_.rows[H+10]=(y(U)-d(U))*.001;let ae=g[9](U),Y=g[10](U),J=g[11](U);_.rows[H+11]=Math.hypot(ae,Y,J),_.rows[H+12]=g[12](U);for(let ee=0;ee<wr;ee++)_.rows[H+13+ee]=x[ee](U);if(M++,++v>hg)throw new Error(`more than ${hg} reports; cut it with knurl replay`)},I="";for(let R=0;R<i.length&&I==="";R+=cf){n.append(i.subarray(R,Math.min(R+cf,i.length)));try{for(let U=n.nextRecord();U;U=n.nextRecord())if(U.type==="Metadata"&&U.name==="knurl")for(let[X,H]of U.metadata)s.set(X,H);else if(U.type==="Schema")r.set(U.id,new TextDecoder().decode(U.data));else if(U.type==="Channel"&&U.topic==="/knurl/scene")u=U.id;else if(U.type==="Channel"&&U.topic==="/knurl/mesh")f=U.id;else if(U.type==="Channel"&&h<0&&fb.test(U.topic)){h=U.id,p=new Hl(r.get(U.schemaId)??"");let X=H=>["x","y","z"].map(ae=>p.reader(`${H}.${ae}`));g=[...X("position"),...X("velocity"),...X("sent_force"),...X("scene_force"),p.reader("state")],x=[...["w","x","y","z"].map(H=>p.reader(`orientation.${H}`)),...X("contact_point"),...X("sent_torque"),...X("scene_force"),p.reader("faults"),p.reader("buttons"),p.reader("flags")],m=p.reader("read_ns"),d=p.reader("deadline_ns"),y=p.reader("write_ns")}else U.type==="Message"&&U.channelId===h?D(U.data):U.type==="Message"&&U.channelId===u?a.push({ns:Number(U.logTime)-c(),text:new TextDecoder().decode(U.data)}):U.type==="Message"&&U.channelId===f&&db(l,U.data)}catch(U){I=U instanceof Error?U.message.split(`
`)[0]:String(U)}await e?.(Math.min(1,(R+cf)/i.length))}if(h<0)throw new Error(I||"an MCAP file, but none that knurl record made (it has no channel /DEVICE/report)");if(v===0)throw new Error(I||(n.done()?"a recording without a report":"cut off before the first reports were complete"));I?o.push(`used up to a damaged place: ${I}`):n.done()||o.push("the file was cut off; what is complete is shown"),E.push(_);let L=new fo(v),k=new Float32Array(v*wr);for(let R=0;R<v;R++){let U=E[R>>12],X=R&4095;L.t[R]=U.t[X];let H=X*S,ae=0;for(let Y of Object.values(L.columns))Y[R]=U.rows[H+ae++];k.set(U.rows.subarray(H+13,H+13+wr),R*wr)}L.count=v;let V=Number(s.get("rate"))||(v>1?(v-1)/(L.last||1):1e3);return{history:L,more:k,metadata:s,scenes:a.map(({ns:R,text:U})=>({t:(R-w)*1e-9,text:U})),meshes:l,period:1/V,notes:o}}var pb=["clamped","stale","guardian","touching","near_singular","at_joint_limit"],Gl=class{constructor(e){this.model=e;oe("open-file").addEventListener("change",t=>{let n=t.target,s=n.files?.[0];n.value="",s&&this.open(s)}),oe("open").addEventListener("click",()=>oe("open-file").click()),oe("play").addEventListener("click",()=>this.toggle()),oe("close-recording").addEventListener("click",()=>this.close()),oe("scrub").addEventListener("input",t=>this.seek(Number(t.target.value)/1e4*this.length)),oe("speed").addEventListener("change",t=>this.speed=Number(t.target.value))}model;recorded=null;playing=!1;speed=1;before=0;arm=[];told=0;whole=[];get length(){return this.recorded?.history.last??0}async open(e){let t=oe("recording-bar");try{Mt(oe("recording-name"),`Reading ${e.name} ...`),t.hidden=!1;let n=new Uint8Array(await e.arrayBuffer()),s=await ug(n,async r=>{Mt(oe("recording-name"),`Reading ${e.name}: ${(100*r).toFixed(0)} %`),await new Promise(o=>window.setTimeout(o))});this.show(e.name,s)}catch(n){t.hidden=this.model.recording===null,ut("error",`${e.name}: ${n.message}`)}}show(e,t){let{history:n,metadata:s}=t;this.whole=[...t.scenes.keys()].filter(x=>t.scenes[x].text.includes('"full":true'));let r=this.figuresIn(t),o=[...this.model.devices.values()].find(x=>x.info.address===s.get("address")||x.info.profile===s.get("profile")),a=[1/0,1/0,1/0],l=[-1/0,-1/0,-1/0],c=1,h=n.columns;for(let x=0;x<n.held;x++){let m=[h.px[x],h.py[x],h.pz[x]];for(let d=0;d<3;d++)a[d]=Math.min(a[d],m[d]),l[d]=Math.max(l[d],m[d]);c=Math.max(c,Math.hypot(h.fx[x],h.fy[x],h.fz[x]))}let u=Math.max(...a.map((x,m)=>Math.max(Math.abs(x),Math.abs(l[m])))),f={i:-1,name:s.get("device")??e,address:s.get("address")??"",profile:s.get("profile")??"",serial:"",rate:Number(s.get("rate"))||1/t.period,centre:o?.info.centre??[0,0,0],radius:o?.info.radius??Math.max(.02,1.15*u),peak_force:o?.info.peak_force??(Number(s.get("limits.peak_force"))>0&&Number.isFinite(Number(s.get("limits.peak_force")))?Number(s.get("limits.peak_force")):Math.ceil(1.2*c)),peak_torque:o?.info.peak_torque??.2,max_stiffness:o?.info.max_stiffness??"inf",damping:0,lag:0,renders_torque:!1,senses_orientation:o?.info.senses_orientation??!1,pull:!1},p=new ma(r?{...r,i:-1,pull:!1}:f,1);Object.assign(p,{history:n}),this.recorded=t,this.told=0,this.arm=[],this.model.recordedMeshes=t.meshes,this.model.recording=p;let g=s.get("version");Mt(oe("recording-name"),`${e}${g?` · Knurl ${g}`:""}${s.get("cause")?` · ${s.get("cause")}`:""} · ${n.held} reports`);for(let x of t.notes)ut("warning",`${e}: ${x}`);this.seek(0),this.setPlaying(!1),this.model.tell("recording"),this.model.tell("servo")}figuresIn(e){let t=e.scenes.find(({text:n})=>n.startsWith('{"op":"servo"'));return t&&JSON.parse(t.text).devices.find(n=>n.name===e.metadata.get("device"))}scenesAt(e,t,n){let{scenes:s}=e;this.told>0&&n<s[this.told-1].t&&(this.told=0);let r=0;for(let o of this.whole)s[o].t<=n&&(r=o);for(this.told<r&&(this.told=r),this.told===0&&(this.arm=[],this.model.takeScene(t,{op:"scene",device:-1,full:!0,claims:[],items:[],gone:[]},1/0));this.told<s.length&&s[this.told].t<=n;this.told++){let o=JSON.parse(s[this.told].text);o.op==="scene"?this.model.takeScene(t,o,1/0):o.op==="felt"?this.model.takeFelt(t,o.items):o.op==="arm"&&(this.arm=o.points)}}close(){this.recorded=null,this.model.recording=null,this.model.recordedMeshes=new Map,oe("recording-bar").hidden=!0,this.model.tell("recording"),this.model.tell("servo")}get isOpen(){return this.recorded!==null}toggle(){this.recorded&&(!this.playing&&this.model.cursor>=this.length&&this.seek(0),this.setPlaying(!this.playing))}setPlaying(e){this.playing=e,Mt(oe("play"),e?"Stop":"Play"),oe("play").setAttribute("aria-pressed",String(e))}step(e){this.recorded&&this.seek(this.model.cursor+e)}seek(e){let t=this.recorded,n=this.model.recording;if(!t||!n)return;this.model.cursor=Math.max(0,Math.min(this.length,e));let s=Math.min(t.history.held-1,t.history.find(this.model.cursor-1e-9)),r=Ul(n,s),o=t.more,a=s*wr;r.q=[o[a],o[a+1],o[a+2],o[a+3]],r.contact=[o[a+4],o[a+5],o[a+6]],r.torque=[o[a+7],o[a+8],o[a+9]],r.scene_force=[o[a+10],o[a+11],o[a+12]],r.faults=Xm(o[a+13]),r.buttons=o[a+14],r.flags=pb.filter((u,f)=>o[a+15]&1<<f),this.scenesAt(t,n,this.model.cursor),r.arm=this.arm,n.frame=r;let l=oe("scrub"),c=String(Math.round(1e4*this.model.cursor/(this.length||1)));l.value!==c&&(l.value=c);let h=`${this.model.cursor.toFixed(3)} of ${this.length.toFixed(2)} s`;Mt(oe("recording-time"),h),l.setAttribute("aria-valuetext",h)}tick(e){let t=(e-this.before)/1e3;this.before=e,this.playing&&(this.seek(this.model.cursor+Math.min(.25,t)*this.speed),this.model.cursor>=this.length&&this.setPlaying(!1))}};var ar={LEFT:0,MIDDLE:1,RIGHT:2,ROTATE:0,DOLLY:1,PAN:2},lr={ROTATE:0,PAN:1,DOLLY_PAN:2,DOLLY_ROTATE:3},Hg=0,zf=1,Gg=2;var Ka=1,Wg=2,zo=3,cr=0,ui=1,di=2,Dr=0,Vo=1,Vf=2,Hf=3,Gf=4,Xg=5;var Nr=100,$g=101,qg=102,Yg=103,Zg=104,Kg=200,Jg=201,jg=202,Qg=203,Wf=204,Xf=205,e0=206,t0=207,n0=208,i0=209,s0=210,r0=211,o0=212,a0=213,l0=214,yc=0,_c=1,xc=2,Po=3,vc=4,bc=5,Mc=6,Sc=7,Jc=0,c0=1,h0=2,ms=0,$f=1,qf=2,Yf=3,Zf=4,Kf=5,Jf=6,jf=7;var Qf=300,Ur=301,Ho=302,jc=303,Qc=304,wc=1e3,fs=1001,Ac=1002,Bn=1003,u0=1004;var Ja=1005;var hi=1006,eh=1007;var Fs=1008;var pi=1009,ed=1010,td=1011,Go=1012,th=1013,Ki=1014,Ji=1015,ji=1016,nh=1017,ih=1018,Fr=1020,nd=35902,id=35899,sd=1021,rd=1022,Qi=1023,Ls=1026,Os=1027,od=1028,sh=1029,hr=1030,rh=1031;var oh=1033,ja=33776,Qa=33777,el=33778,tl=33779,ah=35840,lh=35841,ch=35842,hh=35843,uh=36196,fh=37492,dh=37496,ph=37488,mh=37489,nl=37490,gh=37491,yh=37808,_h=37809,xh=37810,vh=37811,bh=37812,Mh=37813,Sh=37814,wh=37815,Ah=37816,Eh=37817,Th=37818,Ch=37819,Rh=37820,Ih=37821,Ph=36492,Lh=36494,Dh=36495,Nh=36283,Uh=36284,il=36285,Fh=36286;var Ca=2300,Ec=2301,mc=2302,Lf=2303,Df=2400,Nf=2401,Uf=2402;var f0=3200;var Oh=0,d0=1,ks="",Ti="srgb",Ra="srgb-linear",Ia="linear",Dt="srgb";var gc=7680;var p0=519,m0=512,g0=513,y0=514,ad=515,_0=516,x0=517,ld=518,cd=519,v0=35044,Wo=35048;var hd="300 es",ki=2e3,Lo=2001;function mb(i){for(let e=i.length-1;e>=0;--e)if(i[e]>=65535)return!0;return!1}function gb(i){return ArrayBuffer.isView(i)&&!(i instanceof DataView)}function Pa(i){return document.createElementNS("http://www.w3.org/1999/xhtml",i)}function b0(){let i=Pa("canvas");return i.style.display="block",i}var fg={},Do=null;function ud(...i){let e="THREE."+i.shift();Do?Do("log",e,...i):console.log(e,...i)}function M0(i){let e=i[0];if(typeof e=="string"&&e.startsWith("TSL:")){let t=i[1];t&&t.isStackTrace?i[0]+=" "+t.getLocation():i[1]='Stack trace not available. Enable "THREE.Node.captureStackTrace" to capture stack traces.'}return i}function Ye(...i){i=M0(i);let e="THREE."+i.shift();if(Do)Do("warn",e,...i);else{let t=i[0];t&&t.isStackTrace?console.warn(t.getError(e)):console.warn(e,...i)}}function et(...i){i=M0(i);let e="THREE."+i.shift();if(Do)Do("error",e,...i);else{let t=i[0];t&&t.isStackTrace?console.error(t.getError(e)):console.error(e,...i)}}function Ea(...i){let e=i.join(" ");e in fg||(fg[e]=!0,Ye(...i))}function S0(i,e,t){return new Promise(function(n,s){function r(){switch(i.clientWaitSync(e,i.SYNC_FLUSH_COMMANDS_BIT,0)){case i.WAIT_FAILED:s();break;case i.TIMEOUT_EXPIRED:setTimeout(r,t);break;default:n()}}setTimeout(r,t)})}var w0={[yc]:yc,[xc]:Mc,[vc]:vc,[Po]:bc,[_c]:_c,[Mc]:xc,[Sc]:Sc,[bc]:Po},Zi=class{addEventListener(e,t){this._listeners===void 0&&(this._listeners={});let n=this._listeners;n[e]===void 0&&(n[e]=[]),n[e].indexOf(t)===-1&&n[e].push(t)}hasEventListener(e,t){let n=this._listeners;return n===void 0?!1:n[e]!==void 0&&n[e].indexOf(t)!==-1}removeEventListener(e,t){let n=this._listeners;if(n===void 0)return;let s=n[e];if(s!==void 0){let r=s.indexOf(t);r!==-1&&s.splice(r,1)}}dispatchEvent(e){let t=this._listeners;if(t===void 0)return;let n=t[e.type];if(n!==void 0){e.target=this;let s=n.slice(0);for(let r=0,o=s.length;r<o;r++)s[r].call(this,e);e.target=null}}},Kn=["00","01","02","03","04","05","06","07","08","09","0a","0b","0c","0d","0e","0f","10","11","12","13","14","15","16","17","18","19","1a","1b","1c","1d","1e","1f","20","21","22","23","24","25","26","27","28","29","2a","2b","2c","2d","2e","2f","30","31","32","33","34","35","36","37","38","39","3a","3b","3c","3d","3e","3f","40","41","42","43","44","45","46","47","48","49","4a","4b","4c","4d","4e","4f","50","51","52","53","54","55","56","57","58","59","5a","5b","5c","5d","5e","5f","60","61","62","63","64","65","66","67","68","69","6a","6b","6c","6d","6e","6f","70","71","72","73","74","75","76","77","78","79","7a","7b","7c","7d","7e","7f","80","81","82","83","84","85","86","87","88","89","8a","8b","8c","8d","8e","8f","90","91","92","93","94","95","96","97","98","99","9a","9b","9c","9d","9e","9f","a0","a1","a2","a3","a4","a5","a6","a7","a8","a9","aa","ab","ac","ad","ae","af","b0","b1","b2","b3","b4","b5","b6","b7","b8","b9","ba","bb","bc","bd","be","bf","c0","c1","c2","c3","c4","c5","c6","c7","c8","c9","ca","cb","cc","cd","ce","cf","d0","d1","d2","d3","d4","d5","d6","d7","d8","d9","da","db","dc","dd","de","df","e0","e1","e2","e3","e4","e5","e6","e7","e8","e9","ea","eb","ec","ed","ee","ef","f0","f1","f2","f3","f4","f5","f6","f7","f8","f9","fa","fb","fc","fd","fe","ff"],dg=1234567,Ro=Math.PI/180,No=180/Math.PI;function Xo(){let i=Math.random()*4294967295|0,e=Math.random()*4294967295|0,t=Math.random()*4294967295|0,n=Math.random()*4294967295|0;return(Kn[i&255]+Kn[i>>8&255]+Kn[i>>16&255]+Kn[i>>24&255]+"-"+Kn[e&255]+Kn[e>>8&255]+"-"+Kn[e>>16&15|64]+Kn[e>>24&255]+"-"+Kn[t&63|128]+Kn[t>>8&255]+"-"+Kn[t>>16&255]+Kn[t>>24&255]+Kn[n&255]+Kn[n>>8&255]+Kn[n>>16&255]+Kn[n>>24&255]).toLowerCase()}function gt(i,e,t){return Math.max(e,Math.min(t,i))}function fd(i,e){return(i%e+e)%e}function yb(i,e,t,n,s){return n+(i-e)*(s-n)/(t-e)}function _b(i,e,t){return i!==e?(t-i)/(e-i):0}function Ta(i,e,t){return(1-t)*i+t*e}function xb(i,e,t,n){return Ta(i,e,1-Math.exp(-t*n))}function vb(i,e=1){return e-Math.abs(fd(i,e*2)-e)}function bb(i,e,t){return i<=e?0:i>=t?1:(i=(i-e)/(t-e),i*i*(3-2*i))}function Mb(i,e,t){return i<=e?0:i>=t?1:(i=(i-e)/(t-e),i*i*i*(i*(i*6-15)+10))}function Sb(i,e){return i+Math.floor(Math.random()*(e-i+1))}function wb(i,e){return i+Math.random()*(e-i)}function Ab(i){return i*(.5-Math.random())}function Eb(i){i!==void 0&&(dg=i);let e=dg+=1831565813;return e=Math.imul(e^e>>>15,e|1),e^=e+Math.imul(e^e>>>7,e|61),((e^e>>>14)>>>0)/4294967296}function Tb(i){return i*Ro}function Cb(i){return i*No}function Rb(i){return i>0&&Number.isInteger(i)&&2**Math.round(Math.log2(i))===i}function Ib(i){return Math.pow(2,Math.ceil(Math.log(i)/Math.LN2))}function dd(i){return Math.pow(2,Math.floor(Math.log(i)/Math.LN2))}function Pb(i,e,t,n,s){let r=Math.cos,o=Math.sin,a=r(t/2),l=o(t/2),c=r((e+n)/2),h=o((e+n)/2),u=r((e-n)/2),f=o((e-n)/2),p=r((n-e)/2),g=o((n-e)/2);switch(s){case"XYX":i.set(a*h,l*u,l*f,a*c);break;case"YZY":i.set(l*f,a*h,l*u,a*c);break;case"ZXZ":i.set(l*u,l*f,a*h,a*c);break;case"XZX":i.set(a*h,l*g,l*p,a*c);break;case"YXY":i.set(l*p,a*h,l*g,a*c);break;case"ZYZ":i.set(l*g,l*p,a*h,a*c);break;default:Ye("MathUtils: .setQuaternionFromProperEuler() encountered an unknown order: "+s)}}function pd(i){switch(i.constructor){case Uint32Array:return 4294967295;case Uint16Array:return 65535;case Uint8Array:case Uint8ClampedArray:return 255;case Int32Array:return 2147483647;case Int16Array:return 32767;case Int8Array:return 127;default:return}}function A0(i,e){if(e.constructor===Float32Array)return i;let t=pd(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.max(i/t,-1)}function E0(i,e){if(e.constructor===Float32Array)return i;let t=pd(e);if(t===void 0)throw new Error("THREE.MathUtils: Invalid component type.");return Math.round(i*t)}var md={DEG2RAD:Ro,RAD2DEG:No,generateUUID:Xo,clamp:gt,euclideanModulo:fd,mapLinear:yb,inverseLerp:_b,lerp:Ta,damp:xb,pingpong:vb,smoothstep:bb,smootherstep:Mb,randInt:Sb,randFloat:wb,randFloatSpread:Ab,seededRandom:Eb,degToRad:Tb,radToDeg:Cb,isPowerOfTwo:Rb,ceilPowerOfTwo:Ib,floorPowerOfTwo:dd,setQuaternionFromProperEuler:Pb,normalize:E0,denormalize:A0},qe=class{static{this.prototype.isVector2=!0}constructor(e=0,t=0){this.x=e,this.y=t}get width(){return this.x}set width(e){this.x=e}get height(){return this.y}set height(e){this.y=e}set(e,t){return this.x=e,this.y=t,this}setScalar(e){return this.x=e,this.y=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;default:throw new Error("THREE.Vector2: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;default:throw new Error("THREE.Vector2: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y)}copy(e){return this.x=e.x,this.y=e.y,this}add(e){return this.x+=e.x,this.y+=e.y,this}addScalar(e){return this.x+=e,this.y+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this}subScalar(e){return this.x-=e,this.y-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this}multiply(e){return this.x*=e.x,this.y*=e.y,this}multiplyScalar(e){return this.x*=e,this.y*=e,this}divide(e){return this.x/=e.x,this.y/=e.y,this}divideScalar(e){return this.multiplyScalar(1/e)}applyMatrix3(e){let t=this.x,n=this.y,s=e.elements;return this.x=s[0]*t+s[3]*n+s[6],this.y=s[1]*t+s[4]*n+s[7],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this}clamp(e,t){return this.x=gt(this.x,e.x,t.x),this.y=gt(this.y,e.y,t.y),this}clampScalar(e,t){return this.x=gt(this.x,e,t),this.y=gt(this.y,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(gt(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this}negate(){return this.x=-this.x,this.y=-this.y,this}dot(e){return this.x*e.x+this.y*e.y}cross(e){return this.x*e.y-this.y*e.x}lengthSq(){return this.x*this.x+this.y*this.y}length(){return Math.sqrt(this.x*this.x+this.y*this.y)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)}normalize(){return this.divideScalar(this.length()||1)}angle(){return Math.atan2(-this.y,-this.x)+Math.PI}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let n=this.dot(e)/t;return Math.acos(gt(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,n=this.y-e.y;return t*t+n*n}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this}equals(e){return e.x===this.x&&e.y===this.y}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this}rotateAround(e,t){let n=Math.cos(t),s=Math.sin(t),r=this.x-e.x,o=this.y-e.y;return this.x=r*n-o*s+e.x,this.y=r*s+o*n+e.y,this}random(){return this.x=Math.random(),this.y=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y}},tn=class{constructor(e=0,t=0,n=0,s=1){this.isQuaternion=!0,this._x=e,this._y=t,this._z=n,this._w=s}static slerpFlat(e,t,n,s,r,o,a){let l=n[s+0],c=n[s+1],h=n[s+2],u=n[s+3],f=r[o+0],p=r[o+1],g=r[o+2],x=r[o+3];if(u!==x||l!==f||c!==p||h!==g){let m=l*f+c*p+h*g+u*x;m<0&&(f=-f,p=-p,g=-g,x=-x,m=-m);let d=1-a;if(m<.9995){let y=Math.acos(m),w=Math.sin(y);d=Math.sin(d*y)/w,a=Math.sin(a*y)/w,l=l*d+f*a,c=c*d+p*a,h=h*d+g*a,u=u*d+x*a}else{l=l*d+f*a,c=c*d+p*a,h=h*d+g*a,u=u*d+x*a;let y=1/Math.sqrt(l*l+c*c+h*h+u*u);l*=y,c*=y,h*=y,u*=y}}e[t]=l,e[t+1]=c,e[t+2]=h,e[t+3]=u}static multiplyQuaternionsFlat(e,t,n,s,r,o){let a=n[s],l=n[s+1],c=n[s+2],h=n[s+3],u=r[o],f=r[o+1],p=r[o+2],g=r[o+3];return e[t]=a*g+h*u+l*p-c*f,e[t+1]=l*g+h*f+c*u-a*p,e[t+2]=c*g+h*p+a*f-l*u,e[t+3]=h*g-a*u-l*f-c*p,e}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get w(){return this._w}set w(e){this._w=e,this._onChangeCallback()}set(e,t,n,s){return this._x=e,this._y=t,this._z=n,this._w=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._w)}copy(e){return this._x=e.x,this._y=e.y,this._z=e.z,this._w=e.w,this._onChangeCallback(),this}setFromEuler(e,t=!0){let n=e._x,s=e._y,r=e._z,o=e._order,a=Math.cos,l=Math.sin,c=a(n/2),h=a(s/2),u=a(r/2),f=l(n/2),p=l(s/2),g=l(r/2);switch(o){case"XYZ":this._x=f*h*u+c*p*g,this._y=c*p*u-f*h*g,this._z=c*h*g+f*p*u,this._w=c*h*u-f*p*g;break;case"YXZ":this._x=f*h*u+c*p*g,this._y=c*p*u-f*h*g,this._z=c*h*g-f*p*u,this._w=c*h*u+f*p*g;break;case"ZXY":this._x=f*h*u-c*p*g,this._y=c*p*u+f*h*g,this._z=c*h*g+f*p*u,this._w=c*h*u-f*p*g;break;case"ZYX":this._x=f*h*u-c*p*g,this._y=c*p*u+f*h*g,this._z=c*h*g-f*p*u,this._w=c*h*u+f*p*g;break;case"YZX":this._x=f*h*u+c*p*g,this._y=c*p*u+f*h*g,this._z=c*h*g-f*p*u,this._w=c*h*u-f*p*g;break;case"XZY":this._x=f*h*u-c*p*g,this._y=c*p*u-f*h*g,this._z=c*h*g+f*p*u,this._w=c*h*u+f*p*g;break;default:Ye("Quaternion: .setFromEuler() encountered an unknown order: "+o)}return t===!0&&this._onChangeCallback(),this}setFromAxisAngle(e,t){let n=t/2,s=Math.sin(n);return this._x=e.x*s,this._y=e.y*s,this._z=e.z*s,this._w=Math.cos(n),this._onChangeCallback(),this}setFromRotationMatrix(e){let t=e.elements,n=t[0],s=t[4],r=t[8],o=t[1],a=t[5],l=t[9],c=t[2],h=t[6],u=t[10],f=n+a+u;if(f>0){let p=.5/Math.sqrt(f+1);this._w=.25/p,this._x=(h-l)*p,this._y=(r-c)*p,this._z=(o-s)*p}else if(n>a&&n>u){let p=2*Math.sqrt(1+n-a-u);this._w=(h-l)/p,this._x=.25*p,this._y=(s+o)/p,this._z=(r+c)/p}else if(a>u){let p=2*Math.sqrt(1+a-n-u);this._w=(r-c)/p,this._x=(s+o)/p,this._y=.25*p,this._z=(l+h)/p}else{let p=2*Math.sqrt(1+u-n-a);this._w=(o-s)/p,this._x=(r+c)/p,this._y=(l+h)/p,this._z=.25*p}return this._onChangeCallback(),this}setFromUnitVectors(e,t){let n=e.dot(t)+1;return n<1e-8?(n=0,Math.abs(e.x)>Math.abs(e.z)?(this._x=-e.y,this._y=e.x,this._z=0,this._w=n):(this._x=0,this._y=-e.z,this._z=e.y,this._w=n)):(this._x=e.y*t.z-e.z*t.y,this._y=e.z*t.x-e.x*t.z,this._z=e.x*t.y-e.y*t.x,this._w=n),this.normalize()}angleTo(e){return 2*Math.acos(Math.abs(gt(this.dot(e),-1,1)))}rotateTowards(e,t){let n=this.angleTo(e);if(n===0)return this;let s=Math.min(1,t/n);return this.slerp(e,s),this}identity(){return this.set(0,0,0,1)}invert(){return this.conjugate()}conjugate(){return this._x*=-1,this._y*=-1,this._z*=-1,this._onChangeCallback(),this}dot(e){return this._x*e._x+this._y*e._y+this._z*e._z+this._w*e._w}lengthSq(){return this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w}length(){return Math.sqrt(this._x*this._x+this._y*this._y+this._z*this._z+this._w*this._w)}normalize(){let e=this.length();return e===0?(this._x=0,this._y=0,this._z=0,this._w=1):(e=1/e,this._x=this._x*e,this._y=this._y*e,this._z=this._z*e,this._w=this._w*e),this._onChangeCallback(),this}multiply(e){return this.multiplyQuaternions(this,e)}premultiply(e){return this.multiplyQuaternions(e,this)}multiplyQuaternions(e,t){let n=e._x,s=e._y,r=e._z,o=e._w,a=t._x,l=t._y,c=t._z,h=t._w;return this._x=n*h+o*a+s*c-r*l,this._y=s*h+o*l+r*a-n*c,this._z=r*h+o*c+n*l-s*a,this._w=o*h-n*a-s*l-r*c,this._onChangeCallback(),this}slerp(e,t){let n=e._x,s=e._y,r=e._z,o=e._w,a=this.dot(e);a<0&&(n=-n,s=-s,r=-r,o=-o,a=-a);let l=1-t;if(a<.9995){let c=Math.acos(a),h=Math.sin(c);l=Math.sin(l*c)/h,t=Math.sin(t*c)/h,this._x=this._x*l+n*t,this._y=this._y*l+s*t,this._z=this._z*l+r*t,this._w=this._w*l+o*t,this._onChangeCallback()}else this._x=this._x*l+n*t,this._y=this._y*l+s*t,this._z=this._z*l+r*t,this._w=this._w*l+o*t,this.normalize();return this}slerpQuaternions(e,t,n){return this.copy(e).slerp(t,n)}random(){let e=2*Math.PI*Math.random(),t=2*Math.PI*Math.random(),n=Math.random(),s=Math.sqrt(1-n),r=Math.sqrt(n);return this.set(s*Math.sin(e),s*Math.cos(e),r*Math.sin(t),r*Math.cos(t))}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._w===this._w}fromArray(e,t=0){return this._x=e[t],this._y=e[t+1],this._z=e[t+2],this._w=e[t+3],this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._w,e}fromBufferAttribute(e,t){return this._x=e.getX(t),this._y=e.getY(t),this._z=e.getZ(t),this._w=e.getW(t),this._onChangeCallback(),this}toJSON(){return this.toArray()}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._w}},O=class{static{this.prototype.isVector3=!0}constructor(e=0,t=0,n=0){this.x=e,this.y=t,this.z=n}set(e,t,n){return n===void 0&&(n=this.z),this.x=e,this.y=t,this.z=n,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;default:throw new Error("THREE.Vector3: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;default:throw new Error("THREE.Vector3: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this}multiplyVectors(e,t){return this.x=e.x*t.x,this.y=e.y*t.y,this.z=e.z*t.z,this}applyEuler(e){return this.applyQuaternion(pg.setFromEuler(e))}applyAxisAngle(e,t){return this.applyQuaternion(pg.setFromAxisAngle(e,t))}applyMatrix3(e){let t=this.x,n=this.y,s=this.z,r=e.elements;return this.x=r[0]*t+r[3]*n+r[6]*s,this.y=r[1]*t+r[4]*n+r[7]*s,this.z=r[2]*t+r[5]*n+r[8]*s,this}applyNormalMatrix(e){return this.applyMatrix3(e).normalize()}applyMatrix4(e){let t=this.x,n=this.y,s=this.z,r=e.elements,o=1/(r[3]*t+r[7]*n+r[11]*s+r[15]);return this.x=(r[0]*t+r[4]*n+r[8]*s+r[12])*o,this.y=(r[1]*t+r[5]*n+r[9]*s+r[13])*o,this.z=(r[2]*t+r[6]*n+r[10]*s+r[14])*o,this}applyQuaternion(e){let t=this.x,n=this.y,s=this.z,r=e.x,o=e.y,a=e.z,l=e.w,c=2*(o*s-a*n),h=2*(a*t-r*s),u=2*(r*n-o*t);return this.x=t+l*c+o*u-a*h,this.y=n+l*h+a*c-r*u,this.z=s+l*u+r*h-o*c,this}project(e){return this.applyMatrix4(e.matrixWorldInverse).applyMatrix4(e.projectionMatrix)}unproject(e){return this.applyMatrix4(e.projectionMatrixInverse).applyMatrix4(e.matrixWorld)}transformDirection(e){let t=this.x,n=this.y,s=this.z,r=e.elements;return this.x=r[0]*t+r[4]*n+r[8]*s,this.y=r[1]*t+r[5]*n+r[9]*s,this.z=r[2]*t+r[6]*n+r[10]*s,this.normalize()}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this}divideScalar(e){return this.multiplyScalar(1/e)}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this}clamp(e,t){return this.x=gt(this.x,e.x,t.x),this.y=gt(this.y,e.y,t.y),this.z=gt(this.z,e.z,t.z),this}clampScalar(e,t){return this.x=gt(this.x,e,t),this.y=gt(this.y,e,t),this.z=gt(this.z,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(gt(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this}cross(e){return this.crossVectors(this,e)}crossVectors(e,t){let n=e.x,s=e.y,r=e.z,o=t.x,a=t.y,l=t.z;return this.x=s*l-r*a,this.y=r*o-n*l,this.z=n*a-s*o,this}projectOnVector(e){let t=e.lengthSq();if(t===0)return this.set(0,0,0);let n=e.dot(this)/t;return this.copy(e).multiplyScalar(n)}projectOnPlane(e){return hf.copy(this).projectOnVector(e),this.sub(hf)}reflect(e){return this.sub(hf.copy(e).multiplyScalar(2*this.dot(e)))}angleTo(e){let t=Math.sqrt(this.lengthSq()*e.lengthSq());if(t===0)return Math.PI/2;let n=this.dot(e)/t;return Math.acos(gt(n,-1,1))}distanceTo(e){return Math.sqrt(this.distanceToSquared(e))}distanceToSquared(e){let t=this.x-e.x,n=this.y-e.y,s=this.z-e.z;return t*t+n*n+s*s}manhattanDistanceTo(e){return Math.abs(this.x-e.x)+Math.abs(this.y-e.y)+Math.abs(this.z-e.z)}setFromSpherical(e){return this.setFromSphericalCoords(e.radius,e.phi,e.theta)}setFromSphericalCoords(e,t,n){let s=Math.sin(t)*e;return this.x=s*Math.sin(n),this.y=Math.cos(t)*e,this.z=s*Math.cos(n),this}setFromCylindrical(e){return this.setFromCylindricalCoords(e.radius,e.theta,e.y)}setFromCylindricalCoords(e,t,n){return this.x=e*Math.sin(t),this.y=n,this.z=e*Math.cos(t),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this}setFromMatrixScale(e){let t=this.setFromMatrixColumn(e,0).length(),n=this.setFromMatrixColumn(e,1).length(),s=this.setFromMatrixColumn(e,2).length();return this.x=t,this.y=n,this.z=s,this}setFromMatrixColumn(e,t){return this.fromArray(e.elements,t*4)}setFromMatrix3Column(e,t){return this.fromArray(e.elements,t*3)}setFromEuler(e){return this.x=e._x,this.y=e._y,this.z=e._z,this}setFromColor(e){return this.x=e.r,this.y=e.g,this.z=e.b,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this}randomDirection(){let e=Math.random()*Math.PI*2,t=Math.random()*2-1,n=Math.sqrt(1-t*t);return this.x=n*Math.cos(e),this.y=t,this.z=n*Math.sin(e),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z}},hf=new O,pg=new tn,nt=class{static{this.prototype.isMatrix3=!0}constructor(e,t,n,s,r,o,a,l,c){this.elements=[1,0,0,0,1,0,0,0,1],e!==void 0&&this.set(e,t,n,s,r,o,a,l,c)}set(e,t,n,s,r,o,a,l,c){let h=this.elements;return h[0]=e,h[1]=s,h[2]=a,h[3]=t,h[4]=r,h[5]=l,h[6]=n,h[7]=o,h[8]=c,this}identity(){return this.set(1,0,0,0,1,0,0,0,1),this}copy(e){let t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],this}extractBasis(e,t,n){return e.setFromMatrix3Column(this,0),t.setFromMatrix3Column(this,1),n.setFromMatrix3Column(this,2),this}setFromMatrix4(e){let t=e.elements;return this.set(t[0],t[4],t[8],t[1],t[5],t[9],t[2],t[6],t[10]),this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let n=e.elements,s=t.elements,r=this.elements,o=n[0],a=n[3],l=n[6],c=n[1],h=n[4],u=n[7],f=n[2],p=n[5],g=n[8],x=s[0],m=s[3],d=s[6],y=s[1],w=s[4],v=s[7],E=s[2],S=s[5],_=s[8];return r[0]=o*x+a*y+l*E,r[3]=o*m+a*w+l*S,r[6]=o*d+a*v+l*_,r[1]=c*x+h*y+u*E,r[4]=c*m+h*w+u*S,r[7]=c*d+h*v+u*_,r[2]=f*x+p*y+g*E,r[5]=f*m+p*w+g*S,r[8]=f*d+p*v+g*_,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[3]*=e,t[6]*=e,t[1]*=e,t[4]*=e,t[7]*=e,t[2]*=e,t[5]*=e,t[8]*=e,this}determinant(){let e=this.elements,t=e[0],n=e[1],s=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8];return t*o*h-t*a*c-n*r*h+n*a*l+s*r*c-s*o*l}invert(){let e=this.elements,t=e[0],n=e[1],s=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8],u=h*o-a*c,f=a*l-h*r,p=c*r-o*l,g=t*u+n*f+s*p;if(g===0)return this.set(0,0,0,0,0,0,0,0,0);let x=1/g;return e[0]=u*x,e[1]=(s*c-h*n)*x,e[2]=(a*n-s*o)*x,e[3]=f*x,e[4]=(h*t-s*l)*x,e[5]=(s*r-a*t)*x,e[6]=p*x,e[7]=(n*l-c*t)*x,e[8]=(o*t-n*r)*x,this}transpose(){let e,t=this.elements;return e=t[1],t[1]=t[3],t[3]=e,e=t[2],t[2]=t[6],t[6]=e,e=t[5],t[5]=t[7],t[7]=e,this}getNormalMatrix(e){return this.setFromMatrix4(e).invert().transpose()}transposeIntoArray(e){let t=this.elements;return e[0]=t[0],e[1]=t[3],e[2]=t[6],e[3]=t[1],e[4]=t[4],e[5]=t[7],e[6]=t[2],e[7]=t[5],e[8]=t[8],this}setUvTransform(e,t,n,s,r,o,a){let l=Math.cos(r),c=Math.sin(r);return this.set(n*l,n*c,-n*(l*o+c*a)+o+e,-s*c,s*l,-s*(-c*o+l*a)+a+t,0,0,1),this}scale(e,t){return Ea("Matrix3: .scale() is deprecated. Use .makeScale() instead."),this.premultiply(uf.makeScale(e,t)),this}rotate(e){return Ea("Matrix3: .rotate() is deprecated. Use .makeRotation() instead."),this.premultiply(uf.makeRotation(-e)),this}translate(e,t){return Ea("Matrix3: .translate() is deprecated. Use .makeTranslation() instead."),this.premultiply(uf.makeTranslation(e,t)),this}makeTranslation(e,t){return e.isVector2?this.set(1,0,e.x,0,1,e.y,0,0,1):this.set(1,0,e,0,1,t,0,0,1),this}makeRotation(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,n,t,0,0,0,1),this}makeScale(e,t){return this.set(e,0,0,0,t,0,0,0,1),this}equals(e){let t=this.elements,n=e.elements;for(let s=0;s<9;s++)if(t[s]!==n[s])return!1;return!0}fromArray(e,t=0){for(let n=0;n<9;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){let n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e}clone(){return new this.constructor().fromArray(this.elements)}},uf=new nt,mg=new nt().set(.4123908,.3575843,.1804808,.212639,.7151687,.0721923,.0193308,.1191948,.9505322),gg=new nt().set(3.2409699,-1.5373832,-.4986108,-.9692436,1.8759675,.0415551,.0556301,-.203977,1.0569715);function Lb(){let i={enabled:!0,workingColorSpace:Ra,spaces:{},convert:function(s,r,o){return this.enabled===!1||r===o||!r||!o||(this.spaces[r].transfer===Dt&&(s.r=Ps(s.r),s.g=Ps(s.g),s.b=Ps(s.b)),this.spaces[r].primaries!==this.spaces[o].primaries&&(s.applyMatrix3(this.spaces[r].toXYZ),s.applyMatrix3(this.spaces[o].fromXYZ)),this.spaces[o].transfer===Dt&&(s.r=Io(s.r),s.g=Io(s.g),s.b=Io(s.b))),s},workingToColorSpace:function(s,r){return this.convert(s,this.workingColorSpace,r)},colorSpaceToWorking:function(s,r){return this.convert(s,r,this.workingColorSpace)},getPrimaries:function(s){return this.spaces[s].primaries},getTransfer:function(s){return s===ks?Ia:this.spaces[s].transfer},getToneMappingMode:function(s){return this.spaces[s].outputColorSpaceConfig.toneMappingMode||"standard"},getLuminanceCoefficients:function(s,r=this.workingColorSpace){return s.fromArray(this.spaces[r].luminanceCoefficients)},define:function(s){Object.assign(this.spaces,s)},_getMatrix:function(s,r,o){return s.copy(this.spaces[o].fromXYZ).multiply(this.spaces[r].toXYZ)},_getDrawingBufferColorSpace:function(s){return this.spaces[s].outputColorSpaceConfig.drawingBufferColorSpace},_getUnpackColorSpace:function(s=this.workingColorSpace){return this.spaces[s].workingColorSpaceConfig.unpackColorSpace}},e=[.64,.33,.3,.6,.15,.06],t=[.2126,.7152,.0722],n=[.3127,.329];return i.define({[Ra]:{primaries:e,whitePoint:n,transfer:Ia,toXYZ:mg,fromXYZ:gg,luminanceCoefficients:t,workingColorSpaceConfig:{unpackColorSpace:Ti},outputColorSpaceConfig:{drawingBufferColorSpace:Ti}},[Ti]:{primaries:e,whitePoint:n,transfer:Dt,toXYZ:mg,fromXYZ:gg,luminanceCoefficients:t,outputColorSpaceConfig:{drawingBufferColorSpace:Ti}}}),i}var bt=Lb();function Ps(i){return i<.04045?i*.0773993808:Math.pow(i*.9478672986+.0521327014,2.4)}function Io(i){return i<.0031308?i*12.92:1.055*Math.pow(i,.41666)-.055}var go,Tc=class{static getDataURL(e,t="image/png"){if(/^data:/i.test(e.src)||typeof HTMLCanvasElement>"u")return e.src;let n;if(e instanceof HTMLCanvasElement)n=e;else{go===void 0&&(go=Pa("canvas")),go.width=e.width,go.height=e.height;let s=go.getContext("2d");e instanceof ImageData?s.putImageData(e,0,0):s.drawImage(e,0,0,e.width,e.height),n=go}return n.toDataURL(t)}static sRGBToLinear(e){if(typeof HTMLImageElement<"u"&&e instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&e instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&e instanceof ImageBitmap){let t=Pa("canvas");t.width=e.width,t.height=e.height;let n=t.getContext("2d");n.drawImage(e,0,0,e.width,e.height);let s=n.getImageData(0,0,e.width,e.height),r=s.data;for(let o=0;o<r.length;o++)r[o]=Ps(r[o]/255)*255;return n.putImageData(s,0,0),t}else if(e.data){let t=e.data.slice(0);for(let n=0;n<t.length;n++)t instanceof Uint8Array||t instanceof Uint8ClampedArray?t[n]=Math.floor(Ps(t[n]/255)*255):t[n]=Ps(t[n]);return{data:t,width:e.width,height:e.height}}else return Ye("ImageUtils.sRGBToLinear(): Unsupported image type. No color space conversion applied."),e}},Db=0,Uo=class{constructor(e=null){this.isTextureSource=!0,Object.defineProperty(this,"id",{value:Db++}),this.uuid=Xo(),this.data=e,this.dataReady=!0,this.version=0}getSize(e){let t=this.data;return typeof HTMLVideoElement<"u"&&t instanceof HTMLVideoElement?e.set(t.videoWidth,t.videoHeight,0):typeof VideoFrame<"u"&&t instanceof VideoFrame?e.set(t.displayWidth,t.displayHeight,0):t!==null?e.set(t.width||0,t.height||0,t.depth||0):e.set(0,0,0),e}set needsUpdate(e){e===!0&&this.version++}toJSON(e){let t=e===void 0||typeof e=="string";if(!t&&e.images[this.uuid]!==void 0)return e.images[this.uuid];let n={uuid:this.uuid,url:""},s=this.data;if(s!==null){let r;if(Array.isArray(s)){r=[];for(let o=0,a=s.length;o<a;o++)s[o].isDataTexture?r.push(ff(s[o].image)):r.push(ff(s[o]))}else r=ff(s);n.url=r}return t||(e.images[this.uuid]=n),n}};function ff(i){return typeof HTMLImageElement<"u"&&i instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&i instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&i instanceof ImageBitmap?Tc.getDataURL(i):i.data?{data:Array.from(i.data),width:i.width,height:i.height,type:i.data.constructor.name}:(Ye("Texture: Unable to serialize Texture."),{})}var Nb=0,df=new O,fi=class i extends Zi{constructor(e=i.DEFAULT_IMAGE,t=i.DEFAULT_MAPPING,n=fs,s=fs,r=hi,o=Fs,a=Qi,l=pi,c=i.DEFAULT_ANISOTROPY,h=ks){super(),this.isTexture=!0,Object.defineProperty(this,"id",{value:Nb++}),this.uuid=Xo(),this.name="",this.source=new Uo(e),this.mipmaps=[],this.mapping=t,this.channel=0,this.wrapS=n,this.wrapT=s,this.magFilter=r,this.minFilter=o,this.anisotropy=c,this.format=a,this.internalFormat=null,this.type=l,this.offset=new qe(0,0),this.repeat=new qe(1,1),this.center=new qe(0,0),this.rotation=0,this.matrixAutoUpdate=!0,this.matrix=new nt,this.generateMipmaps=!0,this.mipmapsAutoUpdate=!0,this.premultiplyAlpha=!1,this.flipY=!0,this.unpackAlignment=4,this.colorSpace=h,this.userData={},this.updateRanges=[],this.version=0,this.onUpdate=null,this.renderTarget=null,this.isRenderTargetTexture=!1,this.isArrayTexture=!!(e&&e.depth&&e.depth>1),this.pmremVersion=0,this.isPMREMTexture=!1,this.normalized=!1}get width(){return this.source.getSize(df).x}get height(){return this.source.getSize(df).y}get depth(){return this.source.getSize(df).z}get image(){return this.source.data}set image(e){this.source.data=e}updateMatrix(){this.matrix.setUvTransform(this.offset.x,this.offset.y,this.repeat.x,this.repeat.y,this.rotation,this.center.x,this.center.y)}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}clone(){return new this.constructor().copy(this)}copy(e){return this.name=e.name,this.source=e.source,this.mipmaps=e.mipmaps.slice(0),this.mapping=e.mapping,this.channel=e.channel,this.wrapS=e.wrapS,this.wrapT=e.wrapT,this.magFilter=e.magFilter,this.minFilter=e.minFilter,this.anisotropy=e.anisotropy,this.format=e.format,this.internalFormat=e.internalFormat,this.type=e.type,this.normalized=e.normalized,this.offset.copy(e.offset),this.repeat.copy(e.repeat),this.center.copy(e.center),this.rotation=e.rotation,this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrix.copy(e.matrix),this.generateMipmaps=e.generateMipmaps,this.mipmapsAutoUpdate=e.mipmapsAutoUpdate,this.premultiplyAlpha=e.premultiplyAlpha,this.flipY=e.flipY,this.unpackAlignment=e.unpackAlignment,this.colorSpace=e.colorSpace,this.renderTarget=e.renderTarget,this.isRenderTargetTexture=e.isRenderTargetTexture,this.isPMREMTexture=e.isPMREMTexture,this.isArrayTexture=e.isArrayTexture,this.userData=JSON.parse(JSON.stringify(e.userData)),this.needsUpdate=!0,this}setValues(e){for(let t in e){let n=e[t];if(n===void 0){Ye(`Texture.setValues(): parameter '${t}' has value of undefined.`);continue}let s=this[t];if(s===void 0){Ye(`Texture.setValues(): property '${t}' does not exist.`);continue}s&&n&&s.isVector2&&n.isVector2||s&&n&&s.isVector3&&n.isVector3||s&&n&&s.isMatrix3&&n.isMatrix3?s.copy(n):this[t]=n}}toJSON(e){let t=e===void 0||typeof e=="string";if(!t&&e.textures[this.uuid]!==void 0)return e.textures[this.uuid];let n={metadata:{version:4.7,type:"Texture",generator:"Texture.toJSON"},uuid:this.uuid,name:this.name,image:this.source.toJSON(e).uuid,mapping:this.mapping,channel:this.channel,repeat:[this.repeat.x,this.repeat.y],offset:[this.offset.x,this.offset.y],center:[this.center.x,this.center.y],rotation:this.rotation,wrap:[this.wrapS,this.wrapT],format:this.format,internalFormat:this.internalFormat,type:this.type,normalized:this.normalized,colorSpace:this.colorSpace,minFilter:this.minFilter,magFilter:this.magFilter,anisotropy:this.anisotropy,flipY:this.flipY,generateMipmaps:this.generateMipmaps,mipmapsAutoUpdate:this.mipmapsAutoUpdate,premultiplyAlpha:this.premultiplyAlpha,unpackAlignment:this.unpackAlignment};return Object.keys(this.userData).length>0&&(n.userData=this.userData),t||(e.textures[this.uuid]=n),n}dispose(){this.dispatchEvent({type:"dispose"})}transformUv(e){if(this.mapping!==Qf)return e;if(e.applyMatrix3(this.matrix),e.x<0||e.x>1)switch(this.wrapS){case wc:e.x=e.x-Math.floor(e.x);break;case fs:e.x=e.x<0?0:1;break;case Ac:Math.abs(Math.floor(e.x)%2)===1?e.x=Math.ceil(e.x)-e.x:e.x=e.x-Math.floor(e.x);break}if(e.y<0||e.y>1)switch(this.wrapT){case wc:e.y=e.y-Math.floor(e.y);break;case fs:e.y=e.y<0?0:1;break;case Ac:Math.abs(Math.floor(e.y)%2)===1?e.y=Math.ceil(e.y)-e.y:e.y=e.y-Math.floor(e.y);break}return this.flipY&&(e.y=1-e.y),e}set needsUpdate(e){e===!0&&(this.version++,this.source.needsUpdate=!0)}set needsPMREMUpdate(e){e===!0&&this.pmremVersion++}};fi.DEFAULT_IMAGE=null;fi.DEFAULT_MAPPING=Qf;fi.DEFAULT_ANISOTROPY=1;var nn=class{static{this.prototype.isVector4=!0}constructor(e=0,t=0,n=0,s=1){this.x=e,this.y=t,this.z=n,this.w=s}get width(){return this.z}set width(e){this.z=e}get height(){return this.w}set height(e){this.w=e}set(e,t,n,s){return this.x=e,this.y=t,this.z=n,this.w=s,this}setScalar(e){return this.x=e,this.y=e,this.z=e,this.w=e,this}setX(e){return this.x=e,this}setY(e){return this.y=e,this}setZ(e){return this.z=e,this}setW(e){return this.w=e,this}setComponent(e,t){switch(e){case 0:this.x=t;break;case 1:this.y=t;break;case 2:this.z=t;break;case 3:this.w=t;break;default:throw new Error("THREE.Vector4: index is out of range: "+e)}return this}getComponent(e){switch(e){case 0:return this.x;case 1:return this.y;case 2:return this.z;case 3:return this.w;default:throw new Error("THREE.Vector4: index is out of range: "+e)}}clone(){return new this.constructor(this.x,this.y,this.z,this.w)}copy(e){return this.x=e.x,this.y=e.y,this.z=e.z,this.w=e.w!==void 0?e.w:1,this}add(e){return this.x+=e.x,this.y+=e.y,this.z+=e.z,this.w+=e.w,this}addScalar(e){return this.x+=e,this.y+=e,this.z+=e,this.w+=e,this}addVectors(e,t){return this.x=e.x+t.x,this.y=e.y+t.y,this.z=e.z+t.z,this.w=e.w+t.w,this}addScaledVector(e,t){return this.x+=e.x*t,this.y+=e.y*t,this.z+=e.z*t,this.w+=e.w*t,this}sub(e){return this.x-=e.x,this.y-=e.y,this.z-=e.z,this.w-=e.w,this}subScalar(e){return this.x-=e,this.y-=e,this.z-=e,this.w-=e,this}subVectors(e,t){return this.x=e.x-t.x,this.y=e.y-t.y,this.z=e.z-t.z,this.w=e.w-t.w,this}multiply(e){return this.x*=e.x,this.y*=e.y,this.z*=e.z,this.w*=e.w,this}multiplyScalar(e){return this.x*=e,this.y*=e,this.z*=e,this.w*=e,this}applyMatrix4(e){let t=this.x,n=this.y,s=this.z,r=this.w,o=e.elements;return this.x=o[0]*t+o[4]*n+o[8]*s+o[12]*r,this.y=o[1]*t+o[5]*n+o[9]*s+o[13]*r,this.z=o[2]*t+o[6]*n+o[10]*s+o[14]*r,this.w=o[3]*t+o[7]*n+o[11]*s+o[15]*r,this}divide(e){return this.x/=e.x,this.y/=e.y,this.z/=e.z,this.w/=e.w,this}divideScalar(e){return this.multiplyScalar(1/e)}setAxisAngleFromQuaternion(e){this.w=2*Math.acos(e.w);let t=Math.sqrt(1-e.w*e.w);return t<1e-4?(this.x=1,this.y=0,this.z=0):(this.x=e.x/t,this.y=e.y/t,this.z=e.z/t),this}setAxisAngleFromRotationMatrix(e){let t,n,s,r,l=e.elements,c=l[0],h=l[4],u=l[8],f=l[1],p=l[5],g=l[9],x=l[2],m=l[6],d=l[10];if(Math.abs(h-f)<.01&&Math.abs(u-x)<.01&&Math.abs(g-m)<.01){if(Math.abs(h+f)<.1&&Math.abs(u+x)<.1&&Math.abs(g+m)<.1&&Math.abs(c+p+d-3)<.1)return this.set(1,0,0,0),this;t=Math.PI;let w=(c+1)/2,v=(p+1)/2,E=(d+1)/2,S=(h+f)/4,_=(u+x)/4,M=(g+m)/4;return w>v&&w>E?w<.01?(n=0,s=.707106781,r=.707106781):(n=Math.sqrt(w),s=S/n,r=_/n):v>E?v<.01?(n=.707106781,s=0,r=.707106781):(s=Math.sqrt(v),n=S/s,r=M/s):E<.01?(n=.707106781,s=.707106781,r=0):(r=Math.sqrt(E),n=_/r,s=M/r),this.set(n,s,r,t),this}let y=Math.sqrt((m-g)*(m-g)+(u-x)*(u-x)+(f-h)*(f-h));return Math.abs(y)<.001&&(y=1),this.x=(m-g)/y,this.y=(u-x)/y,this.z=(f-h)/y,this.w=Math.acos((c+p+d-1)/2),this}setFromMatrixPosition(e){let t=e.elements;return this.x=t[12],this.y=t[13],this.z=t[14],this.w=t[15],this}min(e){return this.x=Math.min(this.x,e.x),this.y=Math.min(this.y,e.y),this.z=Math.min(this.z,e.z),this.w=Math.min(this.w,e.w),this}max(e){return this.x=Math.max(this.x,e.x),this.y=Math.max(this.y,e.y),this.z=Math.max(this.z,e.z),this.w=Math.max(this.w,e.w),this}clamp(e,t){return this.x=gt(this.x,e.x,t.x),this.y=gt(this.y,e.y,t.y),this.z=gt(this.z,e.z,t.z),this.w=gt(this.w,e.w,t.w),this}clampScalar(e,t){return this.x=gt(this.x,e,t),this.y=gt(this.y,e,t),this.z=gt(this.z,e,t),this.w=gt(this.w,e,t),this}clampLength(e,t){let n=this.length();return this.divideScalar(n||1).multiplyScalar(gt(n,e,t))}floor(){return this.x=Math.floor(this.x),this.y=Math.floor(this.y),this.z=Math.floor(this.z),this.w=Math.floor(this.w),this}ceil(){return this.x=Math.ceil(this.x),this.y=Math.ceil(this.y),this.z=Math.ceil(this.z),this.w=Math.ceil(this.w),this}round(){return this.x=Math.round(this.x),this.y=Math.round(this.y),this.z=Math.round(this.z),this.w=Math.round(this.w),this}roundToZero(){return this.x=Math.trunc(this.x),this.y=Math.trunc(this.y),this.z=Math.trunc(this.z),this.w=Math.trunc(this.w),this}negate(){return this.x=-this.x,this.y=-this.y,this.z=-this.z,this.w=-this.w,this}dot(e){return this.x*e.x+this.y*e.y+this.z*e.z+this.w*e.w}lengthSq(){return this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w}length(){return Math.sqrt(this.x*this.x+this.y*this.y+this.z*this.z+this.w*this.w)}manhattanLength(){return Math.abs(this.x)+Math.abs(this.y)+Math.abs(this.z)+Math.abs(this.w)}normalize(){return this.divideScalar(this.length()||1)}setLength(e){return this.normalize().multiplyScalar(e)}lerp(e,t){return this.x+=(e.x-this.x)*t,this.y+=(e.y-this.y)*t,this.z+=(e.z-this.z)*t,this.w+=(e.w-this.w)*t,this}lerpVectors(e,t,n){return this.x=e.x+(t.x-e.x)*n,this.y=e.y+(t.y-e.y)*n,this.z=e.z+(t.z-e.z)*n,this.w=e.w+(t.w-e.w)*n,this}equals(e){return e.x===this.x&&e.y===this.y&&e.z===this.z&&e.w===this.w}fromArray(e,t=0){return this.x=e[t],this.y=e[t+1],this.z=e[t+2],this.w=e[t+3],this}toArray(e=[],t=0){return e[t]=this.x,e[t+1]=this.y,e[t+2]=this.z,e[t+3]=this.w,e}fromBufferAttribute(e,t){return this.x=e.getX(t),this.y=e.getY(t),this.z=e.getZ(t),this.w=e.getW(t),this}random(){return this.x=Math.random(),this.y=Math.random(),this.z=Math.random(),this.w=Math.random(),this}*[Symbol.iterator](){yield this.x,yield this.y,yield this.z,yield this.w}},Cc=class extends Zi{constructor(e=1,t=1,n={}){super(),n=Object.assign({generateMipmaps:!1,internalFormat:null,minFilter:hi,depthBuffer:!0,stencilBuffer:!1,resolveColorBuffer:!0,resolveDepthBuffer:!0,resolveStencilBuffer:!0,storeMultisampledColorBuffer:!0,storeMultisampledDepthBuffer:!0,storeMultisampledStencilBuffer:!0,depthTexture:null,samples:0,count:1,depth:1,multiview:!1,useArrayDepthTexture:!1},n),this.isRenderTarget=!0,this.width=e,this.height=t,this.depth=n.depth,this.scissor=new nn(0,0,e,t),this.scissorTest=!1,this.viewport=new nn(0,0,e,t),this.textures=[];let s=n.count;for(let r=0;r<s;r++)this.textures[r]=new fi({width:e,height:t,depth:n.depth}),this.textures[r].isRenderTargetTexture=!0,this.textures[r].renderTarget=this;this._setTextureOptions(n),this.depthBuffer=n.depthBuffer,this.stencilBuffer=n.stencilBuffer,this.resolveColorBuffer=n.resolveColorBuffer,this.resolveDepthBuffer=n.resolveDepthBuffer,this.resolveStencilBuffer=n.resolveStencilBuffer,this.storeMultisampledColorBuffer=n.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=n.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=n.storeMultisampledStencilBuffer,this._depthTexture=null,this.depthTexture=n.depthTexture,this.samples=n.samples,this.multiview=n.multiview,this.useArrayDepthTexture=n.useArrayDepthTexture}_setTextureOptions(e={}){let t={minFilter:hi,generateMipmaps:!1,flipY:!1,internalFormat:null};e.mapping!==void 0&&(t.mapping=e.mapping),e.wrapS!==void 0&&(t.wrapS=e.wrapS),e.wrapT!==void 0&&(t.wrapT=e.wrapT),e.wrapR!==void 0&&(t.wrapR=e.wrapR),e.magFilter!==void 0&&(t.magFilter=e.magFilter),e.minFilter!==void 0&&(t.minFilter=e.minFilter),e.format!==void 0&&(t.format=e.format),e.type!==void 0&&(t.type=e.type),e.anisotropy!==void 0&&(t.anisotropy=e.anisotropy),e.colorSpace!==void 0&&(t.colorSpace=e.colorSpace),e.flipY!==void 0&&(t.flipY=e.flipY),e.generateMipmaps!==void 0&&(t.generateMipmaps=e.generateMipmaps),e.mipmapsAutoUpdate!==void 0&&(t.mipmapsAutoUpdate=e.mipmapsAutoUpdate),e.internalFormat!==void 0&&(t.internalFormat=e.internalFormat);for(let n=0;n<this.textures.length;n++)this.textures[n].setValues(t)}get texture(){return this.textures[0]}set texture(e){this.textures[0]=e}set depthTexture(e){this._depthTexture!==null&&this._depthTexture.renderTarget===this&&(this._depthTexture.renderTarget=null),e!==null&&e.renderTarget===null&&(e.renderTarget=this),this._depthTexture=e}get depthTexture(){return this._depthTexture}setSize(e,t,n=1){if(this.width!==e||this.height!==t||this.depth!==n){this.width=e,this.height=t,this.depth=n;for(let s=0,r=this.textures.length;s<r;s++)this.textures[s].image.width=e,this.textures[s].image.height=t,this.textures[s].image.depth=n,this.textures[s].isData3DTexture!==!0&&(this.textures[s].isArrayTexture=this.textures[s].image.depth>1);this.dispose()}this.viewport.set(0,0,e,t),this.scissor.set(0,0,e,t)}clone(){return new this.constructor().copy(this)}copy(e){this.width=e.width,this.height=e.height,this.depth=e.depth,this.scissor.copy(e.scissor),this.scissorTest=e.scissorTest,this.viewport.copy(e.viewport),this.textures.length=0;for(let t=0,n=e.textures.length;t<n;t++){this.textures[t]=e.textures[t].clone(),this.textures[t].isRenderTargetTexture=!0,this.textures[t].renderTarget=this;let s=Object.assign({},e.textures[t].image);this.textures[t].source=new Uo(s)}if(this.depthBuffer=e.depthBuffer,this.stencilBuffer=e.stencilBuffer,this.resolveColorBuffer=e.resolveColorBuffer,this.resolveDepthBuffer=e.resolveDepthBuffer,this.resolveStencilBuffer=e.resolveStencilBuffer,this.storeMultisampledColorBuffer=e.storeMultisampledColorBuffer,this.storeMultisampledDepthBuffer=e.storeMultisampledDepthBuffer,this.storeMultisampledStencilBuffer=e.storeMultisampledStencilBuffer,e.depthTexture!==null)if(e.depthTexture.renderTarget===e){let t=e.depthTexture.clone();t.renderTarget=null,this.depthTexture=t}else this.depthTexture=e.depthTexture;else this.depthTexture=null;return this.samples=e.samples,this.multiview=e.multiview,this.useArrayDepthTexture=e.useArrayDepthTexture,this}dispose(){this.dispatchEvent({type:"dispose"})}},Ci=class extends Cc{constructor(e=1,t=1,n={}){super(e,t,n),this.isWebGLRenderTarget=!0}},La=class extends fi{constructor(e=null,t=1,n=1,s=1){super(null),this.isDataArrayTexture=!0,this.image={data:e,width:t,height:n,depth:s},this.magFilter=Bn,this.minFilter=Bn,this.wrapR=fs,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1,this.layerUpdates=new Set}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}addLayerUpdate(e){this.layerUpdates.add(e)}clearLayerUpdates(){this.layerUpdates.clear()}};var Rc=class extends fi{constructor(e=null,t=1,n=1,s=1){super(null),this.isData3DTexture=!0,this.image={data:e,width:t,height:n,depth:s},this.magFilter=Bn,this.minFilter=Bn,this.wrapR=fs,this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}copy(e){return super.copy(e),this.wrapR=e.wrapR,this}};var Vt=class i{static{this.prototype.isMatrix4=!0}constructor(e,t,n,s,r,o,a,l,c,h,u,f,p,g,x,m){this.elements=[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1],e!==void 0&&this.set(e,t,n,s,r,o,a,l,c,h,u,f,p,g,x,m)}set(e,t,n,s,r,o,a,l,c,h,u,f,p,g,x,m){let d=this.elements;return d[0]=e,d[4]=t,d[8]=n,d[12]=s,d[1]=r,d[5]=o,d[9]=a,d[13]=l,d[2]=c,d[6]=h,d[10]=u,d[14]=f,d[3]=p,d[7]=g,d[11]=x,d[15]=m,this}identity(){return this.set(1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1),this}clone(){return new i().fromArray(this.elements)}copy(e){let t=this.elements,n=e.elements;return t[0]=n[0],t[1]=n[1],t[2]=n[2],t[3]=n[3],t[4]=n[4],t[5]=n[5],t[6]=n[6],t[7]=n[7],t[8]=n[8],t[9]=n[9],t[10]=n[10],t[11]=n[11],t[12]=n[12],t[13]=n[13],t[14]=n[14],t[15]=n[15],this}copyPosition(e){let t=this.elements,n=e.elements;return t[12]=n[12],t[13]=n[13],t[14]=n[14],this}setFromMatrix3(e){let t=e.elements;return this.set(t[0],t[3],t[6],0,t[1],t[4],t[7],0,t[2],t[5],t[8],0,0,0,0,1),this}extractBasis(e,t,n){return this.determinantAffine()===0?(e.set(1,0,0),t.set(0,1,0),n.set(0,0,1),this):(e.setFromMatrixColumn(this,0),t.setFromMatrixColumn(this,1),n.setFromMatrixColumn(this,2),this)}makeBasis(e,t,n){return this.set(e.x,t.x,n.x,0,e.y,t.y,n.y,0,e.z,t.z,n.z,0,0,0,0,1),this}extractRotation(e){if(e.determinantAffine()===0)return this.identity();let t=this.elements,n=e.elements,s=1/yo.setFromMatrixColumn(e,0).length(),r=1/yo.setFromMatrixColumn(e,1).length(),o=1/yo.setFromMatrixColumn(e,2).length();return t[0]=n[0]*s,t[1]=n[1]*s,t[2]=n[2]*s,t[3]=0,t[4]=n[4]*r,t[5]=n[5]*r,t[6]=n[6]*r,t[7]=0,t[8]=n[8]*o,t[9]=n[9]*o,t[10]=n[10]*o,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromEuler(e){let t=this.elements,n=e.x,s=e.y,r=e.z,o=Math.cos(n),a=Math.sin(n),l=Math.cos(s),c=Math.sin(s),h=Math.cos(r),u=Math.sin(r);if(e.order==="XYZ"){let f=o*h,p=o*u,g=a*h,x=a*u;t[0]=l*h,t[4]=-l*u,t[8]=c,t[1]=p+g*c,t[5]=f-x*c,t[9]=-a*l,t[2]=x-f*c,t[6]=g+p*c,t[10]=o*l}else if(e.order==="YXZ"){let f=l*h,p=l*u,g=c*h,x=c*u;t[0]=f+x*a,t[4]=g*a-p,t[8]=o*c,t[1]=o*u,t[5]=o*h,t[9]=-a,t[2]=p*a-g,t[6]=x+f*a,t[10]=o*l}else if(e.order==="ZXY"){let f=l*h,p=l*u,g=c*h,x=c*u;t[0]=f-x*a,t[4]=-o*u,t[8]=g+p*a,t[1]=p+g*a,t[5]=o*h,t[9]=x-f*a,t[2]=-o*c,t[6]=a,t[10]=o*l}else if(e.order==="ZYX"){let f=o*h,p=o*u,g=a*h,x=a*u;t[0]=l*h,t[4]=g*c-p,t[8]=f*c+x,t[1]=l*u,t[5]=x*c+f,t[9]=p*c-g,t[2]=-c,t[6]=a*l,t[10]=o*l}else if(e.order==="YZX"){let f=o*l,p=o*c,g=a*l,x=a*c;t[0]=l*h,t[4]=x-f*u,t[8]=g*u+p,t[1]=u,t[5]=o*h,t[9]=-a*h,t[2]=-c*h,t[6]=p*u+g,t[10]=f-x*u}else if(e.order==="XZY"){let f=o*l,p=o*c,g=a*l,x=a*c;t[0]=l*h,t[4]=-u,t[8]=c*h,t[1]=f*u+x,t[5]=o*h,t[9]=p*u-g,t[2]=g*u-p,t[6]=a*h,t[10]=x*u+f}return t[3]=0,t[7]=0,t[11]=0,t[12]=0,t[13]=0,t[14]=0,t[15]=1,this}makeRotationFromQuaternion(e){return this.compose(Ub,e,Fb)}lookAt(e,t,n){let s=this.elements;return Ai.subVectors(e,t),Ai.lengthSq()===0&&(Ai.z=1),Ai.normalize(),Ys.crossVectors(n,Ai),Ys.lengthSq()===0&&(Math.abs(n.z)===1?Ai.x+=1e-4:Ai.z+=1e-4,Ai.normalize(),Ys.crossVectors(n,Ai)),Ys.normalize(),Wl.crossVectors(Ai,Ys),s[0]=Ys.x,s[4]=Wl.x,s[8]=Ai.x,s[1]=Ys.y,s[5]=Wl.y,s[9]=Ai.y,s[2]=Ys.z,s[6]=Wl.z,s[10]=Ai.z,this}multiply(e){return this.multiplyMatrices(this,e)}premultiply(e){return this.multiplyMatrices(e,this)}multiplyMatrices(e,t){let n=e.elements,s=t.elements,r=this.elements,o=n[0],a=n[4],l=n[8],c=n[12],h=n[1],u=n[5],f=n[9],p=n[13],g=n[2],x=n[6],m=n[10],d=n[14],y=n[3],w=n[7],v=n[11],E=n[15],S=s[0],_=s[4],M=s[8],D=s[12],I=s[1],L=s[5],k=s[9],V=s[13],R=s[2],U=s[6],X=s[10],H=s[14],ae=s[3],Y=s[7],J=s[11],ee=s[15];return r[0]=o*S+a*I+l*R+c*ae,r[4]=o*_+a*L+l*U+c*Y,r[8]=o*M+a*k+l*X+c*J,r[12]=o*D+a*V+l*H+c*ee,r[1]=h*S+u*I+f*R+p*ae,r[5]=h*_+u*L+f*U+p*Y,r[9]=h*M+u*k+f*X+p*J,r[13]=h*D+u*V+f*H+p*ee,r[2]=g*S+x*I+m*R+d*ae,r[6]=g*_+x*L+m*U+d*Y,r[10]=g*M+x*k+m*X+d*J,r[14]=g*D+x*V+m*H+d*ee,r[3]=y*S+w*I+v*R+E*ae,r[7]=y*_+w*L+v*U+E*Y,r[11]=y*M+w*k+v*X+E*J,r[15]=y*D+w*V+v*H+E*ee,this}multiplyScalar(e){let t=this.elements;return t[0]*=e,t[4]*=e,t[8]*=e,t[12]*=e,t[1]*=e,t[5]*=e,t[9]*=e,t[13]*=e,t[2]*=e,t[6]*=e,t[10]*=e,t[14]*=e,t[3]*=e,t[7]*=e,t[11]*=e,t[15]*=e,this}determinant(){let e=this.elements,t=e[0],n=e[4],s=e[8],r=e[12],o=e[1],a=e[5],l=e[9],c=e[13],h=e[2],u=e[6],f=e[10],p=e[14],g=e[3],x=e[7],m=e[11],d=e[15],y=l*p-c*f,w=a*p-c*u,v=a*f-l*u,E=o*p-c*h,S=o*f-l*h,_=o*u-a*h;return t*(x*y-m*w+d*v)-n*(g*y-m*E+d*S)+s*(g*w-x*E+d*_)-r*(g*v-x*S+m*_)}determinantAffine(){let e=this.elements,t=e[0],n=e[4],s=e[8],r=e[1],o=e[5],a=e[9],l=e[2],c=e[6],h=e[10];return t*(o*h-a*c)-n*(r*h-a*l)+s*(r*c-o*l)}transpose(){let e=this.elements,t;return t=e[1],e[1]=e[4],e[4]=t,t=e[2],e[2]=e[8],e[8]=t,t=e[6],e[6]=e[9],e[9]=t,t=e[3],e[3]=e[12],e[12]=t,t=e[7],e[7]=e[13],e[13]=t,t=e[11],e[11]=e[14],e[14]=t,this}setPosition(e,t,n){let s=this.elements;return e.isVector3?(s[12]=e.x,s[13]=e.y,s[14]=e.z):(s[12]=e,s[13]=t,s[14]=n),this}invert(){let e=this.elements,t=e[0],n=e[1],s=e[2],r=e[3],o=e[4],a=e[5],l=e[6],c=e[7],h=e[8],u=e[9],f=e[10],p=e[11],g=e[12],x=e[13],m=e[14],d=e[15],y=t*a-n*o,w=t*l-s*o,v=t*c-r*o,E=n*l-s*a,S=n*c-r*a,_=s*c-r*l,M=h*x-u*g,D=h*m-f*g,I=h*d-p*g,L=u*m-f*x,k=u*d-p*x,V=f*d-p*m,R=y*V-w*k+v*L+E*I-S*D+_*M;if(R===0)return this.set(0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0);let U=1/R;return e[0]=(a*V-l*k+c*L)*U,e[1]=(s*k-n*V-r*L)*U,e[2]=(x*_-m*S+d*E)*U,e[3]=(f*S-u*_-p*E)*U,e[4]=(l*I-o*V-c*D)*U,e[5]=(t*V-s*I+r*D)*U,e[6]=(m*v-g*_-d*w)*U,e[7]=(h*_-f*v+p*w)*U,e[8]=(o*k-a*I+c*M)*U,e[9]=(n*I-t*k-r*M)*U,e[10]=(g*S-x*v+d*y)*U,e[11]=(u*v-h*S-p*y)*U,e[12]=(a*D-o*L-l*M)*U,e[13]=(t*L-n*D+s*M)*U,e[14]=(x*w-g*E-m*y)*U,e[15]=(h*E-u*w+f*y)*U,this}scale(e){let t=this.elements,n=e.x,s=e.y,r=e.z;return t[0]*=n,t[4]*=s,t[8]*=r,t[1]*=n,t[5]*=s,t[9]*=r,t[2]*=n,t[6]*=s,t[10]*=r,t[3]*=n,t[7]*=s,t[11]*=r,this}getMaxScaleOnAxis(){let e=this.elements,t=e[0]*e[0]+e[1]*e[1]+e[2]*e[2],n=e[4]*e[4]+e[5]*e[5]+e[6]*e[6],s=e[8]*e[8]+e[9]*e[9]+e[10]*e[10];return Math.sqrt(Math.max(t,n,s))}makeTranslation(e,t,n){return e.isVector3?this.set(1,0,0,e.x,0,1,0,e.y,0,0,1,e.z,0,0,0,1):this.set(1,0,0,e,0,1,0,t,0,0,1,n,0,0,0,1),this}makeRotationX(e){let t=Math.cos(e),n=Math.sin(e);return this.set(1,0,0,0,0,t,-n,0,0,n,t,0,0,0,0,1),this}makeRotationY(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,0,n,0,0,1,0,0,-n,0,t,0,0,0,0,1),this}makeRotationZ(e){let t=Math.cos(e),n=Math.sin(e);return this.set(t,-n,0,0,n,t,0,0,0,0,1,0,0,0,0,1),this}makeRotationAxis(e,t){let n=Math.cos(t),s=Math.sin(t),r=1-n,o=e.x,a=e.y,l=e.z,c=r*o,h=r*a;return this.set(c*o+n,c*a-s*l,c*l+s*a,0,c*a+s*l,h*a+n,h*l-s*o,0,c*l-s*a,h*l+s*o,r*l*l+n,0,0,0,0,1),this}makeScale(e,t,n){return this.set(e,0,0,0,0,t,0,0,0,0,n,0,0,0,0,1),this}makeShear(e,t,n,s,r,o){return this.set(1,n,r,0,e,1,o,0,t,s,1,0,0,0,0,1),this}compose(e,t,n){let s=this.elements,r=t._x,o=t._y,a=t._z,l=t._w,c=r+r,h=o+o,u=a+a,f=r*c,p=r*h,g=r*u,x=o*h,m=o*u,d=a*u,y=l*c,w=l*h,v=l*u,E=n.x,S=n.y,_=n.z;return s[0]=(1-(x+d))*E,s[1]=(p+v)*E,s[2]=(g-w)*E,s[3]=0,s[4]=(p-v)*S,s[5]=(1-(f+d))*S,s[6]=(m+y)*S,s[7]=0,s[8]=(g+w)*_,s[9]=(m-y)*_,s[10]=(1-(f+x))*_,s[11]=0,s[12]=e.x,s[13]=e.y,s[14]=e.z,s[15]=1,this}decompose(e,t,n){let s=this.elements;e.x=s[12],e.y=s[13],e.z=s[14];let r=this.determinantAffine();if(r===0)return n.set(1,1,1),t.identity(),this;let o=yo.set(s[0],s[1],s[2]).length(),a=yo.set(s[4],s[5],s[6]).length(),l=yo.set(s[8],s[9],s[10]).length();r<0&&(o=-o),$i.copy(this);let c=1/o,h=1/a,u=1/l;return $i.elements[0]*=c,$i.elements[1]*=c,$i.elements[2]*=c,$i.elements[4]*=h,$i.elements[5]*=h,$i.elements[6]*=h,$i.elements[8]*=u,$i.elements[9]*=u,$i.elements[10]*=u,t.setFromRotationMatrix($i),n.x=o,n.y=a,n.z=l,this}makePerspective(e,t,n,s,r,o,a=ki,l=!1){let c=this.elements,h=2*r/(t-e),u=2*r/(n-s),f=(t+e)/(t-e),p=(n+s)/(n-s),g,x;if(l)g=r/(o-r),x=o*r/(o-r);else if(a===ki)g=-(o+r)/(o-r),x=-2*o*r/(o-r);else if(a===Lo)g=-o/(o-r),x=-o*r/(o-r);else throw new Error("THREE.Matrix4.makePerspective(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=f,c[12]=0,c[1]=0,c[5]=u,c[9]=p,c[13]=0,c[2]=0,c[6]=0,c[10]=g,c[14]=x,c[3]=0,c[7]=0,c[11]=-1,c[15]=0,this}makeOrthographic(e,t,n,s,r,o,a=ki,l=!1){let c=this.elements,h=2/(t-e),u=2/(n-s),f=-(t+e)/(t-e),p=-(n+s)/(n-s),g,x;if(l)g=1/(o-r),x=o/(o-r);else if(a===ki)g=-2/(o-r),x=-(o+r)/(o-r);else if(a===Lo)g=-1/(o-r),x=-r/(o-r);else throw new Error("THREE.Matrix4.makeOrthographic(): Invalid coordinate system: "+a);return c[0]=h,c[4]=0,c[8]=0,c[12]=f,c[1]=0,c[5]=u,c[9]=0,c[13]=p,c[2]=0,c[6]=0,c[10]=g,c[14]=x,c[3]=0,c[7]=0,c[11]=0,c[15]=1,this}equals(e){let t=this.elements,n=e.elements;for(let s=0;s<16;s++)if(t[s]!==n[s])return!1;return!0}fromArray(e,t=0){for(let n=0;n<16;n++)this.elements[n]=e[n+t];return this}toArray(e=[],t=0){let n=this.elements;return e[t]=n[0],e[t+1]=n[1],e[t+2]=n[2],e[t+3]=n[3],e[t+4]=n[4],e[t+5]=n[5],e[t+6]=n[6],e[t+7]=n[7],e[t+8]=n[8],e[t+9]=n[9],e[t+10]=n[10],e[t+11]=n[11],e[t+12]=n[12],e[t+13]=n[13],e[t+14]=n[14],e[t+15]=n[15],e}},yo=new O,$i=new Vt,Ub=new O(0,0,0),Fb=new O(1,1,1),Ys=new O,Wl=new O,Ai=new O,yg=new Vt,_g=new tn,Ds=class i{constructor(e=0,t=0,n=0,s=i.DEFAULT_ORDER){this.isEuler=!0,this._x=e,this._y=t,this._z=n,this._order=s}get x(){return this._x}set x(e){this._x=e,this._onChangeCallback()}get y(){return this._y}set y(e){this._y=e,this._onChangeCallback()}get z(){return this._z}set z(e){this._z=e,this._onChangeCallback()}get order(){return this._order}set order(e){this._order=e,this._onChangeCallback()}set(e,t,n,s=this._order){return this._x=e,this._y=t,this._z=n,this._order=s,this._onChangeCallback(),this}clone(){return new this.constructor(this._x,this._y,this._z,this._order)}copy(e){return this._x=e._x,this._y=e._y,this._z=e._z,this._order=e._order,this._onChangeCallback(),this}setFromRotationMatrix(e,t=this._order,n=!0){let s=e.elements,r=s[0],o=s[4],a=s[8],l=s[1],c=s[5],h=s[9],u=s[2],f=s[6],p=s[10];switch(t){case"XYZ":this._y=Math.asin(gt(a,-1,1)),Math.abs(a)<.9999999?(this._x=Math.atan2(-h,p),this._z=Math.atan2(-o,r)):(this._x=Math.atan2(f,c),this._z=0);break;case"YXZ":this._x=Math.asin(-gt(h,-1,1)),Math.abs(h)<.9999999?(this._y=Math.atan2(a,p),this._z=Math.atan2(l,c)):(this._y=Math.atan2(-u,r),this._z=0);break;case"ZXY":this._x=Math.asin(gt(f,-1,1)),Math.abs(f)<.9999999?(this._y=Math.atan2(-u,p),this._z=Math.atan2(-o,c)):(this._y=0,this._z=Math.atan2(l,r));break;case"ZYX":this._y=Math.asin(-gt(u,-1,1)),Math.abs(u)<.9999999?(this._x=Math.atan2(f,p),this._z=Math.atan2(l,r)):(this._x=0,this._z=Math.atan2(-o,c));break;case"YZX":this._z=Math.asin(gt(l,-1,1)),Math.abs(l)<.9999999?(this._x=Math.atan2(-h,c),this._y=Math.atan2(-u,r)):(this._x=0,this._y=Math.atan2(a,p));break;case"XZY":this._z=Math.asin(-gt(o,-1,1)),Math.abs(o)<.9999999?(this._x=Math.atan2(f,c),this._y=Math.atan2(a,r)):(this._x=Math.atan2(-h,p),this._y=0);break;default:Ye("Euler: .setFromRotationMatrix() encountered an unknown order: "+t)}return this._order=t,n===!0&&this._onChangeCallback(),this}setFromQuaternion(e,t,n){return yg.makeRotationFromQuaternion(e),this.setFromRotationMatrix(yg,t,n)}setFromVector3(e,t=this._order){return this.set(e.x,e.y,e.z,t)}reorder(e){return _g.setFromEuler(this),this.setFromQuaternion(_g,e)}equals(e){return e._x===this._x&&e._y===this._y&&e._z===this._z&&e._order===this._order}fromArray(e){return this._x=e[0],this._y=e[1],this._z=e[2],e[3]!==void 0&&(this._order=e[3]),this._onChangeCallback(),this}toArray(e=[],t=0){return e[t]=this._x,e[t+1]=this._y,e[t+2]=this._z,e[t+3]=this._order,e}_onChange(e){return this._onChangeCallback=e,this}_onChangeCallback(){}*[Symbol.iterator](){yield this._x,yield this._y,yield this._z,yield this._order}};Ds.DEFAULT_ORDER="XYZ";var Fo=class{constructor(){this.mask=1}set(e){this.mask=(1<<e|0)>>>0}enable(e){this.mask|=1<<e|0}enableAll(){this.mask=-1}toggle(e){this.mask^=1<<e|0}disable(e){this.mask&=~(1<<e|0)}disableAll(){this.mask=0}test(e){return(this.mask&e.mask)!==0}isEnabled(e){return(this.mask&(1<<e|0))!==0}},Ob=0,xg=new O,_o=new tn,As=new Vt,Xl=new O,ba=new O,kb=new O,Bb=new tn,vg=new O(1,0,0),bg=new O(0,1,0),Mg=new O(0,0,1),Sg={type:"added"},zb={type:"removed"},xo={type:"childadded",child:null},pf={type:"childremoved",child:null},Qn=class i extends Zi{constructor(){super(),this.isObject3D=!0,Object.defineProperty(this,"id",{value:Ob++}),this.uuid=Xo(),this.name="",this.type="Object3D",this.parent=null,this.children=[],this.up=i.DEFAULT_UP.clone();let e=new O,t=new Ds,n=new tn,s=new O(1,1,1);function r(){n.setFromEuler(t,!1)}function o(){t.setFromQuaternion(n,void 0,!1)}t._onChange(r),n._onChange(o),Object.defineProperties(this,{position:{configurable:!0,enumerable:!0,value:e},rotation:{configurable:!0,enumerable:!0,value:t},quaternion:{configurable:!0,enumerable:!0,value:n},scale:{configurable:!0,enumerable:!0,value:s},modelViewMatrix:{value:new Vt},normalMatrix:{value:new nt}}),this.matrix=new Vt,this.matrixWorld=new Vt,this.matrixAutoUpdate=i.DEFAULT_MATRIX_AUTO_UPDATE,this.matrixWorldAutoUpdate=i.DEFAULT_MATRIX_WORLD_AUTO_UPDATE,this.matrixWorldNeedsUpdate=!1,this.layers=new Fo,this.visible=!0,this.castShadow=!1,this.receiveShadow=!1,this.frustumCulled=!0,this.renderOrder=0,this.animations=[],this.customDepthMaterial=void 0,this.customDistanceMaterial=void 0,this.static=!1,this.userData={},this.pivot=null}onBeforeShadow(){}onAfterShadow(){}onBeforeRender(){}onAfterRender(){}applyMatrix4(e){this.matrixAutoUpdate&&this.updateMatrix(),this.matrix.premultiply(e),this.matrix.decompose(this.position,this.quaternion,this.scale),this.pivot!==null&&this.position.copy(this.pivot).applyMatrix4(this.matrix).sub(this.pivot)}applyQuaternion(e){return this.quaternion.premultiply(e),this}setRotationFromAxisAngle(e,t){this.quaternion.setFromAxisAngle(e,t)}setRotationFromEuler(e){this.quaternion.setFromEuler(e,!0)}setRotationFromMatrix(e){this.quaternion.setFromRotationMatrix(e)}setRotationFromQuaternion(e){this.quaternion.copy(e)}rotateOnAxis(e,t){return _o.setFromAxisAngle(e,t),this.quaternion.multiply(_o),this}rotateOnWorldAxis(e,t){return _o.setFromAxisAngle(e,t),this.quaternion.premultiply(_o),this}rotateX(e){return this.rotateOnAxis(vg,e)}rotateY(e){return this.rotateOnAxis(bg,e)}rotateZ(e){return this.rotateOnAxis(Mg,e)}translateOnAxis(e,t){return xg.copy(e).applyQuaternion(this.quaternion),this.position.add(xg.multiplyScalar(t)),this}translateX(e){return this.translateOnAxis(vg,e)}translateY(e){return this.translateOnAxis(bg,e)}translateZ(e){return this.translateOnAxis(Mg,e)}localToWorld(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(this.matrixWorld)}worldToLocal(e){return this.updateWorldMatrix(!0,!1),e.applyMatrix4(As.copy(this.matrixWorld).invert())}lookAt(e,t,n){e.isVector3?Xl.copy(e):Xl.set(e,t,n);let s=this.parent;this.updateWorldMatrix(!0,!1),ba.setFromMatrixPosition(this.matrixWorld),this.isCamera||this.isLight?As.lookAt(ba,Xl,this.up):As.lookAt(Xl,ba,this.up),this.quaternion.setFromRotationMatrix(As),s&&(As.extractRotation(s.matrixWorld),_o.setFromRotationMatrix(As),this.quaternion.premultiply(_o.invert()))}add(e){if(arguments.length>1){for(let t=0;t<arguments.length;t++)this.add(arguments[t]);return this}return e===this?(et("Object3D.add: object can't be added as a child of itself.",e),this):(e&&e.isObject3D?(e.removeFromParent(),e.parent=this,this.children.push(e),e.dispatchEvent(Sg),xo.child=e,this.dispatchEvent(xo),xo.child=null):et("Object3D.add: object not an instance of THREE.Object3D.",e),this)}remove(e){if(arguments.length>1){for(let n=0;n<arguments.length;n++)this.remove(arguments[n]);return this}let t=this.children.indexOf(e);return t!==-1&&(e.parent=null,this.children.splice(t,1),e.dispatchEvent(zb),pf.child=e,this.dispatchEvent(pf),pf.child=null),this}removeFromParent(){let e=this.parent;return e!==null&&e.remove(this),this}clear(){return this.remove(...this.children)}attach(e){return this.updateWorldMatrix(!0,!1),As.copy(this.matrixWorld).invert(),e.parent!==null&&(e.parent.updateWorldMatrix(!0,!1),As.multiply(e.parent.matrixWorld)),e.applyMatrix4(As),e.removeFromParent(),e.parent=this,this.children.push(e),e.updateWorldMatrix(!1,!0),e.dispatchEvent(Sg),xo.child=e,this.dispatchEvent(xo),xo.child=null,this}getObjectById(e){return this.getObjectByProperty("id",e)}getObjectByName(e){return this.getObjectByProperty("name",e)}getObjectByProperty(e,t){if(this[e]===t)return this;for(let n=0,s=this.children.length;n<s;n++){let o=this.children[n].getObjectByProperty(e,t);if(o!==void 0)return o}}getObjectsByProperty(e,t,n=[]){this[e]===t&&n.push(this);let s=this.children;for(let r=0,o=s.length;r<o;r++)s[r].getObjectsByProperty(e,t,n);return n}getWorldPosition(e){return this.updateWorldMatrix(!0,!1),e.setFromMatrixPosition(this.matrixWorld)}getWorldQuaternion(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ba,e,kb),e}getWorldScale(e){return this.updateWorldMatrix(!0,!1),this.matrixWorld.decompose(ba,Bb,e),e}getWorldDirection(e){this.updateWorldMatrix(!0,!1);let t=this.matrixWorld.elements;return e.set(t[8],t[9],t[10]).normalize()}raycast(){}intersectsFrustum(){return!0}traverse(e){e(this);let t=this.children;for(let n=0,s=t.length;n<s;n++)t[n].traverse(e)}traverseVisible(e){if(this.visible===!1)return;e(this);let t=this.children;for(let n=0,s=t.length;n<s;n++)t[n].traverseVisible(e)}traverseAncestors(e){let t=this.parent;t!==null&&(e(t),t.traverseAncestors(e))}updateMatrix(){this.matrix.compose(this.position,this.quaternion,this.scale);let e=this.pivot;if(e!==null){let t=e.x,n=e.y,s=e.z,r=this.matrix.elements;r[12]+=t-r[0]*t-r[4]*n-r[8]*s,r[13]+=n-r[1]*t-r[5]*n-r[9]*s,r[14]+=s-r[2]*t-r[6]*n-r[10]*s}this.matrixWorldNeedsUpdate=!0}updateMatrixWorld(e){this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||e)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,e=!0);let t=this.children;for(let n=0,s=t.length;n<s;n++)t[n].updateMatrixWorld(e)}updateWorldMatrix(e,t,n=!1){let s=this.parent;if(e===!0&&s!==null&&s.updateWorldMatrix(!0,!1),this.matrixAutoUpdate&&this.updateMatrix(),(this.matrixWorldNeedsUpdate||n)&&(this.matrixWorldAutoUpdate===!0&&(this.parent===null?this.matrixWorld.copy(this.matrix):this.matrixWorld.multiplyMatrices(this.parent.matrixWorld,this.matrix)),this.matrixWorldNeedsUpdate=!1,n=!0),t===!0){let r=this.children;for(let o=0,a=r.length;o<a;o++)r[o].updateWorldMatrix(!1,!0,n)}}toJSON(e){let t=e===void 0||typeof e=="string",n={};t&&(e={geometries:{},materials:{},textures:{},images:{},shapes:{},skeletons:{},animations:{},nodes:{}},n.metadata={version:4.7,type:"Object",generator:"Object3D.toJSON"});let s={};s.uuid=this.uuid,s.type=this.type,s.name=this.name,s.castShadow=this.castShadow,s.receiveShadow=this.receiveShadow,s.visible=this.visible,s.frustumCulled=this.frustumCulled,s.renderOrder=this.renderOrder,s.static=this.static,s.matrixAutoUpdate=this.matrixAutoUpdate,Object.keys(this.userData).length>0&&(s.userData=this.userData),s.layers=this.layers.mask,s.matrix=this.matrix.toArray(),s.up=this.up.toArray(),this.pivot!==null&&(s.pivot=this.pivot.toArray()),this.morphTargetDictionary!==void 0&&(s.morphTargetDictionary=Object.assign({},this.morphTargetDictionary)),this.morphTargetInfluences!==void 0&&(s.morphTargetInfluences=this.morphTargetInfluences.slice()),this.isInstancedMesh&&(s.type="InstancedMesh",s.count=this.count,s.instanceMatrix=this.instanceMatrix.toJSON(),this.instanceColor!==null&&(s.instanceColor=this.instanceColor.toJSON())),this.isBatchedMesh&&(s.type="BatchedMesh",s.perObjectFrustumCulled=this.perObjectFrustumCulled,s.sortObjects=this.sortObjects,s.drawRanges=this._drawRanges,s.reservedRanges=this._reservedRanges,s.geometryInfo=this._geometryInfo.map(a=>({...a,boundingBox:a.boundingBox?a.boundingBox.toJSON():void 0,boundingSphere:a.boundingSphere?a.boundingSphere.toJSON():void 0})),s.instanceInfo=this._instanceInfo.map(a=>({...a})),s.availableInstanceIds=this._availableInstanceIds.slice(),s.availableGeometryIds=this._availableGeometryIds.slice(),s.nextIndexStart=this._nextIndexStart,s.nextVertexStart=this._nextVertexStart,s.geometryCount=this._geometryCount,s.maxInstanceCount=this._maxInstanceCount,s.maxVertexCount=this._maxVertexCount,s.maxIndexCount=this._maxIndexCount,s.geometryInitialized=this._geometryInitialized,s.matricesTexture=this._matricesTexture.toJSON(e),s.indirectTexture=this._indirectTexture.toJSON(e),this._colorsTexture!==null&&(s.colorsTexture=this._colorsTexture.toJSON(e)),this.boundingSphere!==null&&(s.boundingSphere=this.boundingSphere.toJSON()),this.boundingBox!==null&&(s.boundingBox=this.boundingBox.toJSON()));function r(a,l){return a[l.uuid]===void 0&&(a[l.uuid]=l.toJSON(e)),l.uuid}if(this.isScene)this.background&&(this.background.isColor?s.background=this.background.toJSON():this.background.isTexture&&(s.background=this.background.toJSON(e).uuid)),this.environment&&this.environment.isTexture&&this.environment.isRenderTargetTexture!==!0&&(s.environment=this.environment.toJSON(e).uuid);else if(this.isMesh||this.isLine||this.isPoints){s.geometry=r(e.geometries,this.geometry);let a=this.geometry.parameters;if(a!==void 0&&a.shapes!==void 0){let l=a.shapes;if(Array.isArray(l))for(let c=0,h=l.length;c<h;c++){let u=l[c];r(e.shapes,u)}else r(e.shapes,l)}}if(this.isSkinnedMesh&&(s.bindMode=this.bindMode,s.bindMatrix=this.bindMatrix.toArray(),this.skeleton!==void 0&&(r(e.skeletons,this.skeleton),s.skeleton=this.skeleton.uuid)),this.material!==void 0)if(Array.isArray(this.material)){let a=[];for(let l=0,c=this.material.length;l<c;l++)a.push(r(e.materials,this.material[l]));s.material=a}else s.material=r(e.materials,this.material);if(this.children.length>0){s.children=[];for(let a=0;a<this.children.length;a++)s.children.push(this.children[a].toJSON(e).object)}if(this.animations.length>0){s.animations=[];for(let a=0;a<this.animations.length;a++){let l=this.animations[a];s.animations.push(r(e.animations,l))}}if(t){let a=o(e.geometries),l=o(e.materials),c=o(e.textures),h=o(e.images),u=o(e.shapes),f=o(e.skeletons),p=o(e.animations),g=o(e.nodes);a.length>0&&(n.geometries=a),l.length>0&&(n.materials=l),c.length>0&&(n.textures=c),h.length>0&&(n.images=h),u.length>0&&(n.shapes=u),f.length>0&&(n.skeletons=f),p.length>0&&(n.animations=p),g.length>0&&(n.nodes=g)}return n.object=s,n;function o(a){let l=[];for(let c in a){let h=a[c];delete h.metadata,l.push(h)}return l}}clone(e){return new this.constructor().copy(this,e)}copy(e,t=!0){if(this.name=e.name,this.up.copy(e.up),this.position.copy(e.position),this.rotation.order=e.rotation.order,this.quaternion.copy(e.quaternion),this.scale.copy(e.scale),this.pivot=e.pivot!==null?e.pivot.clone():null,this.matrix.copy(e.matrix),this.matrixWorld.copy(e.matrixWorld),this.matrixAutoUpdate=e.matrixAutoUpdate,this.matrixWorldAutoUpdate=e.matrixWorldAutoUpdate,this.matrixWorldNeedsUpdate=e.matrixWorldNeedsUpdate,this.layers.mask=e.layers.mask,this.visible=e.visible,this.castShadow=e.castShadow,this.receiveShadow=e.receiveShadow,this.frustumCulled=e.frustumCulled,this.renderOrder=e.renderOrder,this.static=e.static,this.animations=e.animations.slice(),this.userData=JSON.parse(JSON.stringify(e.userData)),t===!0)for(let n=0;n<e.children.length;n++){let s=e.children[n];this.add(s.clone())}return this}dispose(){this.dispatchEvent({type:"dispose"})}};Qn.DEFAULT_UP=new O(0,1,0);Qn.DEFAULT_MATRIX_AUTO_UPDATE=!0;Qn.DEFAULT_MATRIX_WORLD_AUTO_UPDATE=!0;var wt=class extends Qn{constructor(){super(),this.isGroup=!0,this.type="Group"}},Vb={type:"move"},Oo=class{constructor(){this._targetRay=null,this._grip=null,this._hand=null}getHandSpace(){return this._hand===null&&(this._hand=new wt,this._hand.matrixAutoUpdate=!1,this._hand.visible=!1,this._hand.joints={},this._hand.inputState={pinching:!1}),this._hand}getTargetRaySpace(){return this._targetRay===null&&(this._targetRay=new wt,this._targetRay.matrixAutoUpdate=!1,this._targetRay.visible=!1,this._targetRay.hasLinearVelocity=!1,this._targetRay.linearVelocity=new O,this._targetRay.hasAngularVelocity=!1,this._targetRay.angularVelocity=new O),this._targetRay}getGripSpace(){return this._grip===null&&(this._grip=new wt,this._grip.matrixAutoUpdate=!1,this._grip.visible=!1,this._grip.hasLinearVelocity=!1,this._grip.linearVelocity=new O,this._grip.hasAngularVelocity=!1,this._grip.angularVelocity=new O,this._grip.eventsEnabled=!1),this._grip}dispatchEvent(e){return this._targetRay!==null&&this._targetRay.dispatchEvent(e),this._grip!==null&&this._grip.dispatchEvent(e),this._hand!==null&&this._hand.dispatchEvent(e),this}connect(e){if(e&&e.hand){let t=this._hand;if(t)for(let n of e.hand.values())this._getHandJoint(t,n)}return this.dispatchEvent({type:"connected",data:e}),this}disconnect(e){return this.dispatchEvent({type:"disconnected",data:e}),this._targetRay!==null&&(this._targetRay.visible=!1),this._grip!==null&&(this._grip.visible=!1),this._hand!==null&&(this._hand.visible=!1),this}update(e,t,n){let s=null,r=null,o=null,a=this._targetRay,l=this._grip,c=this._hand;if(e&&t.session.visibilityState!=="visible-blurred"){if(c&&e.hand){o=!0;for(let x of e.hand.values()){let m=t.getJointPose(x,n),d=this._getHandJoint(c,x);m!==null&&(d.matrix.fromArray(m.transform.matrix),d.matrix.decompose(d.position,d.quaternion,d.scale),d.matrixWorldNeedsUpdate=!0,d.jointRadius=m.radius),d.visible=m!==null}let h=c.joints["index-finger-tip"],u=c.joints["thumb-tip"],f=h.position.distanceTo(u.position),p=.02,g=.005;c.inputState.pinching&&f>p+g?(c.inputState.pinching=!1,this.dispatchEvent({type:"pinchend",handedness:e.handedness,target:this})):!c.inputState.pinching&&f<=p-g&&(c.inputState.pinching=!0,this.dispatchEvent({type:"pinchstart",handedness:e.handedness,target:this}))}else l!==null&&e.gripSpace&&(r=t.getPose(e.gripSpace,n),r!==null&&(l.matrix.fromArray(r.transform.matrix),l.matrix.decompose(l.position,l.quaternion,l.scale),l.matrixWorldNeedsUpdate=!0,r.linearVelocity?(l.hasLinearVelocity=!0,l.linearVelocity.copy(r.linearVelocity)):l.hasLinearVelocity=!1,r.angularVelocity?(l.hasAngularVelocity=!0,l.angularVelocity.copy(r.angularVelocity)):l.hasAngularVelocity=!1,l.eventsEnabled&&l.dispatchEvent({type:"gripUpdated",data:e,target:this})));a!==null&&(s=t.getPose(e.targetRaySpace,n),s===null&&r!==null&&(s=r),s!==null&&(a.matrix.fromArray(s.transform.matrix),a.matrix.decompose(a.position,a.quaternion,a.scale),a.matrixWorldNeedsUpdate=!0,s.linearVelocity?(a.hasLinearVelocity=!0,a.linearVelocity.copy(s.linearVelocity)):a.hasLinearVelocity=!1,s.angularVelocity?(a.hasAngularVelocity=!0,a.angularVelocity.copy(s.angularVelocity)):a.hasAngularVelocity=!1,this.dispatchEvent(Vb)))}return a!==null&&(a.visible=s!==null),l!==null&&(l.visible=r!==null),c!==null&&(c.visible=o!==null),this}_getHandJoint(e,t){if(e.joints[t.jointName]===void 0){let n=new wt;n.matrixAutoUpdate=!1,n.visible=!1,e.joints[t.jointName]=n,e.add(n)}return e.joints[t.jointName]}},T0={aliceblue:15792383,antiquewhite:16444375,aqua:65535,aquamarine:8388564,azure:15794175,beige:16119260,bisque:16770244,black:0,blanchedalmond:16772045,blue:255,blueviolet:9055202,brown:10824234,burlywood:14596231,cadetblue:6266528,chartreuse:8388352,chocolate:13789470,coral:16744272,cornflowerblue:6591981,cornsilk:16775388,crimson:14423100,cyan:65535,darkblue:139,darkcyan:35723,darkgoldenrod:12092939,darkgray:11119017,darkgreen:25600,darkgrey:11119017,darkkhaki:12433259,darkmagenta:9109643,darkolivegreen:5597999,darkorange:16747520,darkorchid:10040012,darkred:9109504,darksalmon:15308410,darkseagreen:9419919,darkslateblue:4734347,darkslategray:3100495,darkslategrey:3100495,darkturquoise:52945,darkviolet:9699539,deeppink:16716947,deepskyblue:49151,dimgray:6908265,dimgrey:6908265,dodgerblue:2003199,firebrick:11674146,floralwhite:16775920,forestgreen:2263842,fuchsia:16711935,gainsboro:14474460,ghostwhite:16316671,gold:16766720,goldenrod:14329120,gray:8421504,green:32768,greenyellow:11403055,grey:8421504,honeydew:15794160,hotpink:16738740,indianred:13458524,indigo:4915330,ivory:16777200,khaki:15787660,lavender:15132410,lavenderblush:16773365,lawngreen:8190976,lemonchiffon:16775885,lightblue:11393254,lightcoral:15761536,lightcyan:14745599,lightgoldenrodyellow:16448210,lightgray:13882323,lightgreen:9498256,lightgrey:13882323,lightpink:16758465,lightsalmon:16752762,lightseagreen:2142890,lightskyblue:8900346,lightslategray:7833753,lightslategrey:7833753,lightsteelblue:11584734,lightyellow:16777184,lime:65280,limegreen:3329330,linen:16445670,magenta:16711935,maroon:8388608,mediumaquamarine:6737322,mediumblue:205,mediumorchid:12211667,mediumpurple:9662683,mediumseagreen:3978097,mediumslateblue:8087790,mediumspringgreen:64154,mediumturquoise:4772300,mediumvioletred:13047173,midnightblue:1644912,mintcream:16121850,mistyrose:16770273,moccasin:16770229,navajowhite:16768685,navy:128,oldlace:16643558,olive:8421376,olivedrab:7048739,orange:16753920,orangered:16729344,orchid:14315734,palegoldenrod:15657130,palegreen:10025880,paleturquoise:11529966,palevioletred:14381203,papayawhip:16773077,peachpuff:16767673,peru:13468991,pink:16761035,plum:14524637,powderblue:11591910,purple:8388736,rebeccapurple:6697881,red:16711680,rosybrown:12357519,royalblue:4286945,saddlebrown:9127187,salmon:16416882,sandybrown:16032864,seagreen:3050327,seashell:16774638,sienna:10506797,silver:12632256,skyblue:8900331,slateblue:6970061,slategray:7372944,slategrey:7372944,snow:16775930,springgreen:65407,steelblue:4620980,tan:13808780,teal:32896,thistle:14204888,tomato:16737095,turquoise:4251856,violet:15631086,wheat:16113331,white:16777215,whitesmoke:16119285,yellow:16776960,yellowgreen:10145074},Zs={h:0,s:0,l:0},$l={h:0,s:0,l:0};function mf(i,e,t){return t<0&&(t+=1),t>1&&(t-=1),t<1/6?i+(e-i)*6*t:t<1/2?e:t<2/3?i+(e-i)*6*(2/3-t):i}var dt=class{constructor(e,t,n){return this.isColor=!0,this.r=1,this.g=1,this.b=1,this.set(e,t,n)}set(e,t,n){if(t===void 0&&n===void 0){let s=e;s&&s.isColor?this.copy(s):typeof s=="number"?this.setHex(s):typeof s=="string"&&this.setStyle(s)}else this.setRGB(e,t,n);return this}setScalar(e){return this.r=e,this.g=e,this.b=e,this}setHex(e,t=Ti){return e=Math.floor(e),this.r=(e>>16&255)/255,this.g=(e>>8&255)/255,this.b=(e&255)/255,bt.colorSpaceToWorking(this,t),this}setRGB(e,t,n,s=bt.workingColorSpace){return this.r=e,this.g=t,this.b=n,bt.colorSpaceToWorking(this,s),this}setHSL(e,t,n,s=bt.workingColorSpace){if(e=fd(e,1),t=gt(t,0,1),n=gt(n,0,1),t===0)this.r=this.g=this.b=n;else{let r=n<=.5?n*(1+t):n+t-n*t,o=2*n-r;this.r=mf(o,r,e+1/3),this.g=mf(o,r,e),this.b=mf(o,r,e-1/3)}return bt.colorSpaceToWorking(this,s),this}setStyle(e,t=Ti){function n(r){r!==void 0&&parseFloat(r)<1&&Ye("Color: Alpha component of "+e+" will be ignored.")}let s;if(s=/^(\w+)\(([^\)]*)\)/.exec(e)){let r,o=s[1],a=s[2];switch(o){case"rgb":case"rgba":if(r=/^\s*(\d+)\s*,\s*(\d+)\s*,\s*(\d+)\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(255,parseInt(r[1],10))/255,Math.min(255,parseInt(r[2],10))/255,Math.min(255,parseInt(r[3],10))/255,t);if(r=/^\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setRGB(Math.min(100,parseFloat(r[1]))/100,Math.min(100,parseFloat(r[2]))/100,Math.min(100,parseFloat(r[3]))/100,t);break;case"hsl":case"hsla":if(r=/^\s*([+-]?(?:\d+(?:\.\d+)?|\.\d+))\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*,\s*(\d+(?:\.\d+)?|\.\d+)\%\s*(?:,\s*(\d+(?:\.\d+)?|\.\d+)\s*)?$/.exec(a))return n(r[4]),this.setHSL(parseFloat(r[1])/360,parseFloat(r[2])/100,parseFloat(r[3])/100,t);break;default:Ye("Color: Unknown color model "+e)}}else if(s=/^\#([A-Fa-f\d]+)$/.exec(e)){let r=s[1],o=r.length;if(o===3)return this.setRGB(parseInt(r.charAt(0),16)/15,parseInt(r.charAt(1),16)/15,parseInt(r.charAt(2),16)/15,t);if(o===6)return this.setHex(parseInt(r,16),t);Ye("Color: Invalid hex color "+e)}else if(e&&e.length>0)return this.setColorName(e,t);return this}setColorName(e,t=Ti){let n=T0[e.toLowerCase()];return n!==void 0?this.setHex(n,t):Ye("Color: Unknown color "+e),this}clone(){return new this.constructor(this.r,this.g,this.b)}copy(e){return this.r=e.r,this.g=e.g,this.b=e.b,this}copySRGBToLinear(e){return this.r=Ps(e.r),this.g=Ps(e.g),this.b=Ps(e.b),this}copyLinearToSRGB(e){return this.r=Io(e.r),this.g=Io(e.g),this.b=Io(e.b),this}convertSRGBToLinear(){return this.copySRGBToLinear(this),this}convertLinearToSRGB(){return this.copyLinearToSRGB(this),this}getHex(e=Ti){return bt.workingToColorSpace(Jn.copy(this),e),Math.round(gt(Jn.r*255,0,255))*65536+Math.round(gt(Jn.g*255,0,255))*256+Math.round(gt(Jn.b*255,0,255))}getHexString(e=Ti){return("000000"+this.getHex(e).toString(16)).slice(-6)}getHSL(e,t=bt.workingColorSpace){bt.workingToColorSpace(Jn.copy(this),t);let n=Jn.r,s=Jn.g,r=Jn.b,o=Math.max(n,s,r),a=Math.min(n,s,r),l,c,h=(a+o)/2;if(a===o)l=0,c=0;else{let u=o-a;switch(c=h<=.5?u/(o+a):u/(2-o-a),o){case n:l=(s-r)/u+(s<r?6:0);break;case s:l=(r-n)/u+2;break;case r:l=(n-s)/u+4;break}l/=6}return e.h=l,e.s=c,e.l=h,e}getRGB(e,t=bt.workingColorSpace){return bt.workingToColorSpace(Jn.copy(this),t),e.r=Jn.r,e.g=Jn.g,e.b=Jn.b,e}getStyle(e=Ti){bt.workingToColorSpace(Jn.copy(this),e);let t=Jn.r,n=Jn.g,s=Jn.b;return e!==Ti?`color(${e} ${t.toFixed(3)} ${n.toFixed(3)} ${s.toFixed(3)})`:`rgb(${Math.round(t*255)},${Math.round(n*255)},${Math.round(s*255)})`}offsetHSL(e,t,n){return this.getHSL(Zs),this.setHSL(Zs.h+e,Zs.s+t,Zs.l+n)}add(e){return this.r+=e.r,this.g+=e.g,this.b+=e.b,this}addColors(e,t){return this.r=e.r+t.r,this.g=e.g+t.g,this.b=e.b+t.b,this}addScalar(e){return this.r+=e,this.g+=e,this.b+=e,this}sub(e){return this.r=Math.max(0,this.r-e.r),this.g=Math.max(0,this.g-e.g),this.b=Math.max(0,this.b-e.b),this}multiply(e){return this.r*=e.r,this.g*=e.g,this.b*=e.b,this}multiplyScalar(e){return this.r*=e,this.g*=e,this.b*=e,this}lerp(e,t){return this.r+=(e.r-this.r)*t,this.g+=(e.g-this.g)*t,this.b+=(e.b-this.b)*t,this}lerpColors(e,t,n){return this.r=e.r+(t.r-e.r)*n,this.g=e.g+(t.g-e.g)*n,this.b=e.b+(t.b-e.b)*n,this}lerpHSL(e,t){this.getHSL(Zs),e.getHSL($l);let n=Ta(Zs.h,$l.h,t),s=Ta(Zs.s,$l.s,t),r=Ta(Zs.l,$l.l,t);return this.setHSL(n,s,r),this}setFromVector3(e){return this.r=e.x,this.g=e.y,this.b=e.z,this}applyMatrix3(e){let t=this.r,n=this.g,s=this.b,r=e.elements;return this.r=r[0]*t+r[3]*n+r[6]*s,this.g=r[1]*t+r[4]*n+r[7]*s,this.b=r[2]*t+r[5]*n+r[8]*s,this}equals(e){return e.r===this.r&&e.g===this.g&&e.b===this.b}fromArray(e,t=0){return this.r=e[t],this.g=e[t+1],this.b=e[t+2],this}toArray(e=[],t=0){return e[t]=this.r,e[t+1]=this.g,e[t+2]=this.b,e}fromBufferAttribute(e,t){return this.r=e.getX(t),this.g=e.getY(t),this.b=e.getZ(t),this}toJSON(){return this.getHex()}*[Symbol.iterator](){yield this.r,yield this.g,yield this.b}},Jn=new dt;dt.NAMES=T0;var Da=class extends Qn{constructor(){super(),this.isScene=!0,this.type="Scene",this.background=null,this.environment=null,this.fog=null,this.backgroundBlurriness=0,this.backgroundIntensity=1,this.backgroundRotation=new Ds,this.environmentIntensity=1,this.environmentRotation=new Ds,this.overrideMaterial=null,typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}copy(e,t){return super.copy(e,t),this.background=e.background!==null?e.background.clone():null,this.environment=e.environment!==null?e.environment.clone():null,this.fog=e.fog!==null?e.fog.clone():null,this.backgroundBlurriness=e.backgroundBlurriness,this.backgroundIntensity=e.backgroundIntensity,this.backgroundRotation.copy(e.backgroundRotation),this.environmentIntensity=e.environmentIntensity,this.environmentRotation.copy(e.environmentRotation),this.overrideMaterial=e.overrideMaterial!==null?e.overrideMaterial.clone():null,this.matrixAutoUpdate=e.matrixAutoUpdate,this}toJSON(e){let t=super.toJSON(e);return this.fog!==null&&(t.object.fog=this.fog.toJSON()),t.object.backgroundBlurriness=this.backgroundBlurriness,t.object.backgroundIntensity=this.backgroundIntensity,t.object.backgroundRotation=this.backgroundRotation.toArray(),t.object.environmentIntensity=this.environmentIntensity,t.object.environmentRotation=this.environmentRotation.toArray(),t}},qi=new O,Es=new O,gf=new O,Ts=new O,vo=new O,bo=new O,wg=new O,yf=new O,_f=new O,xf=new O,vf=new nn,bf=new nn,Mf=new nn,Is=class i{constructor(e=new O,t=new O,n=new O){this.a=e,this.b=t,this.c=n}static getNormal(e,t,n,s){s.subVectors(n,t),qi.subVectors(e,t),s.cross(qi);let r=s.lengthSq();return r>0?s.multiplyScalar(1/Math.sqrt(r)):s.set(0,0,0)}static getBarycoord(e,t,n,s,r){qi.subVectors(s,t),Es.subVectors(n,t),gf.subVectors(e,t);let o=qi.dot(qi),a=qi.dot(Es),l=qi.dot(gf),c=Es.dot(Es),h=Es.dot(gf),u=o*c-a*a;if(u===0)return r.set(0,0,0),null;let f=1/u,p=(c*l-a*h)*f,g=(o*h-a*l)*f;return r.set(1-p-g,g,p)}static containsPoint(e,t,n,s){return this.getBarycoord(e,t,n,s,Ts)===null?!1:Ts.x>=0&&Ts.y>=0&&Ts.x+Ts.y<=1}static getInterpolation(e,t,n,s,r,o,a,l){return this.getBarycoord(e,t,n,s,Ts)===null?(l.x=0,l.y=0,"z"in l&&(l.z=0),"w"in l&&(l.w=0),null):(l.setScalar(0),l.addScaledVector(r,Ts.x),l.addScaledVector(o,Ts.y),l.addScaledVector(a,Ts.z),l)}static getInterpolatedAttribute(e,t,n,s,r,o){return vf.setScalar(0),bf.setScalar(0),Mf.setScalar(0),vf.fromBufferAttribute(e,t),bf.fromBufferAttribute(e,n),Mf.fromBufferAttribute(e,s),o.setScalar(0),o.addScaledVector(vf,r.x),o.addScaledVector(bf,r.y),o.addScaledVector(Mf,r.z),o}static isFrontFacing(e,t,n,s){return qi.subVectors(n,t),Es.subVectors(e,t),qi.cross(Es).dot(s)<0}set(e,t,n){return this.a.copy(e),this.b.copy(t),this.c.copy(n),this}setFromPointsAndIndices(e,t,n,s){return this.a.copy(e[t]),this.b.copy(e[n]),this.c.copy(e[s]),this}setFromAttributeAndIndices(e,t,n,s){return this.a.fromBufferAttribute(e,t),this.b.fromBufferAttribute(e,n),this.c.fromBufferAttribute(e,s),this}clone(){return new this.constructor().copy(this)}copy(e){return this.a.copy(e.a),this.b.copy(e.b),this.c.copy(e.c),this}getArea(){return qi.subVectors(this.c,this.b),Es.subVectors(this.a,this.b),qi.cross(Es).length()*.5}getMidpoint(e){return e.addVectors(this.a,this.b).add(this.c).multiplyScalar(1/3)}getNormal(e){return i.getNormal(this.a,this.b,this.c,e)}getPlane(e){return e.setFromCoplanarPoints(this.a,this.b,this.c)}getBarycoord(e,t){return i.getBarycoord(e,this.a,this.b,this.c,t)}getInterpolation(e,t,n,s,r){return i.getInterpolation(e,this.a,this.b,this.c,t,n,s,r)}containsPoint(e){return i.containsPoint(e,this.a,this.b,this.c)}isFrontFacing(e){return i.isFrontFacing(this.a,this.b,this.c,e)}intersectsBox(e){return e.intersectsTriangle(this)}closestPointToPoint(e,t){let n=this.a,s=this.b,r=this.c,o,a;vo.subVectors(s,n),bo.subVectors(r,n),yf.subVectors(e,n);let l=vo.dot(yf),c=bo.dot(yf);if(l<=0&&c<=0)return t.copy(n);_f.subVectors(e,s);let h=vo.dot(_f),u=bo.dot(_f);if(h>=0&&u<=h)return t.copy(s);let f=l*u-h*c;if(f<=0&&l>=0&&h<=0&&l-h>0)return o=l/(l-h),t.copy(n).addScaledVector(vo,o);xf.subVectors(e,r);let p=vo.dot(xf),g=bo.dot(xf);if(g>=0&&p<=g)return t.copy(r);let x=p*c-l*g;if(x<=0&&c>=0&&g<=0)return a=c/(c-g),t.copy(n).addScaledVector(bo,a);let m=h*g-p*u;if(m<=0&&u-h>=0&&p-g>=0)return wg.subVectors(r,s),a=(u-h)/(u-h+(p-g)),t.copy(s).addScaledVector(wg,a);let d=1/(m+x+f);return o=x*d,a=f*d,t.copy(n).addScaledVector(vo,o).addScaledVector(bo,a)}equals(e){return e.a.equals(this.a)&&e.b.equals(this.b)&&e.c.equals(this.c)}},ds=class{constructor(e=new O(1/0,1/0,1/0),t=new O(-1/0,-1/0,-1/0)){this.isBox3=!0,this.min=e,this.max=t}set(e,t){return this.min.copy(e),this.max.copy(t),this}setFromArray(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t+=3)this.expandByPoint(Yi.fromArray(e,t));return this}setFromBufferAttribute(e){this.makeEmpty();for(let t=0,n=e.count;t<n;t++)this.expandByPoint(Yi.fromBufferAttribute(e,t));return this}setFromPoints(e){this.makeEmpty();for(let t=0,n=e.length;t<n;t++)this.expandByPoint(e[t]);return this}setFromCenterAndSize(e,t){let n=Yi.copy(t).multiplyScalar(.5);return this.min.copy(e).sub(n),this.max.copy(e).add(n),this}setFromObject(e,t=!1){return this.makeEmpty(),this.expandByObject(e,t)}clone(){return new this.constructor().copy(this)}copy(e){return this.min.copy(e.min),this.max.copy(e.max),this}makeEmpty(){return this.min.x=this.min.y=this.min.z=1/0,this.max.x=this.max.y=this.max.z=-1/0,this}isEmpty(){return this.max.x<this.min.x||this.max.y<this.min.y||this.max.z<this.min.z}getCenter(e){return this.isEmpty()?e.set(0,0,0):e.addVectors(this.min,this.max).multiplyScalar(.5)}getSize(e){return this.isEmpty()?e.set(0,0,0):e.subVectors(this.max,this.min)}expandByPoint(e){return this.min.min(e),this.max.max(e),this}expandByVector(e){return this.min.sub(e),this.max.add(e),this}expandByScalar(e){return this.min.addScalar(-e),this.max.addScalar(e),this}expandByObject(e,t=!1){e.updateWorldMatrix(!1,!1);let n=e.geometry;if(n!==void 0){let r=n.getAttribute("position");if(t===!0&&r!==void 0&&e.isInstancedMesh!==!0&&e.isBatchedMesh!==!0)for(let o=0,a=r.count;o<a;o++)e.isMesh===!0?e.getVertexPosition(o,Yi):Yi.fromBufferAttribute(r,o),Yi.applyMatrix4(e.matrixWorld),this.expandByPoint(Yi);else e.boundingBox!==void 0?(e.boundingBox===null&&e.computeBoundingBox(),ql.copy(e.boundingBox)):(n.boundingBox===null&&n.computeBoundingBox(),ql.copy(n.boundingBox)),ql.applyMatrix4(e.matrixWorld),this.union(ql)}let s=e.children;for(let r=0,o=s.length;r<o;r++)this.expandByObject(s[r],t);return this}containsPoint(e){return e.x>=this.min.x&&e.x<=this.max.x&&e.y>=this.min.y&&e.y<=this.max.y&&e.z>=this.min.z&&e.z<=this.max.z}containsBox(e){return this.min.x<=e.min.x&&e.max.x<=this.max.x&&this.min.y<=e.min.y&&e.max.y<=this.max.y&&this.min.z<=e.min.z&&e.max.z<=this.max.z}getParameter(e,t){return t.set((e.x-this.min.x)/(this.max.x-this.min.x),(e.y-this.min.y)/(this.max.y-this.min.y),(e.z-this.min.z)/(this.max.z-this.min.z))}intersectsBox(e){return e.max.x>=this.min.x&&e.min.x<=this.max.x&&e.max.y>=this.min.y&&e.min.y<=this.max.y&&e.max.z>=this.min.z&&e.min.z<=this.max.z}intersectsSphere(e){return this.clampPoint(e.center,Yi),Yi.distanceToSquared(e.center)<=e.radius*e.radius}intersectsPlane(e){let t,n;return e.normal.x>0?(t=e.normal.x*this.min.x,n=e.normal.x*this.max.x):(t=e.normal.x*this.max.x,n=e.normal.x*this.min.x),e.normal.y>0?(t+=e.normal.y*this.min.y,n+=e.normal.y*this.max.y):(t+=e.normal.y*this.max.y,n+=e.normal.y*this.min.y),e.normal.z>0?(t+=e.normal.z*this.min.z,n+=e.normal.z*this.max.z):(t+=e.normal.z*this.max.z,n+=e.normal.z*this.min.z),t<=-e.constant&&n>=-e.constant}intersectsTriangle(e){if(this.isEmpty())return!1;this.getCenter(Ma),Yl.subVectors(this.max,Ma),Mo.subVectors(e.a,Ma),So.subVectors(e.b,Ma),wo.subVectors(e.c,Ma),Ks.subVectors(So,Mo),Js.subVectors(wo,So),Ar.subVectors(Mo,wo);let t=[0,-Ks.z,Ks.y,0,-Js.z,Js.y,0,-Ar.z,Ar.y,Ks.z,0,-Ks.x,Js.z,0,-Js.x,Ar.z,0,-Ar.x,-Ks.y,Ks.x,0,-Js.y,Js.x,0,-Ar.y,Ar.x,0];return!Sf(t,Mo,So,wo,Yl)||(t=[1,0,0,0,1,0,0,0,1],!Sf(t,Mo,So,wo,Yl))?!1:(Zl.crossVectors(Ks,Js),t=[Zl.x,Zl.y,Zl.z],Sf(t,Mo,So,wo,Yl))}clampPoint(e,t){return t.copy(e).clamp(this.min,this.max)}distanceToPoint(e){return this.clampPoint(e,Yi).distanceTo(e)}getBoundingSphere(e){return this.isEmpty()?e.makeEmpty():(this.getCenter(e.center),e.radius=this.getSize(Yi).length()*.5),e}intersect(e){return this.min.max(e.min),this.max.min(e.max),this.isEmpty()&&this.makeEmpty(),this}union(e){return this.min.min(e.min),this.max.max(e.max),this}applyMatrix4(e){return this.isEmpty()?this:(Cs[0].set(this.min.x,this.min.y,this.min.z).applyMatrix4(e),Cs[1].set(this.min.x,this.min.y,this.max.z).applyMatrix4(e),Cs[2].set(this.min.x,this.max.y,this.min.z).applyMatrix4(e),Cs[3].set(this.min.x,this.max.y,this.max.z).applyMatrix4(e),Cs[4].set(this.max.x,this.min.y,this.min.z).applyMatrix4(e),Cs[5].set(this.max.x,this.min.y,this.max.z).applyMatrix4(e),Cs[6].set(this.max.x,this.max.y,this.min.z).applyMatrix4(e),Cs[7].set(this.max.x,this.max.y,this.max.z).applyMatrix4(e),this.setFromPoints(Cs),this)}translate(e){return this.min.add(e),this.max.add(e),this}equals(e){return e.min.equals(this.min)&&e.max.equals(this.max)}toJSON(){return{min:this.min.toArray(),max:this.max.toArray()}}fromJSON(e){return this.min.fromArray(e.min),this.max.fromArray(e.max),this}},Cs=[new O,new O,new O,new O,new O,new O,new O,new O],Yi=new O,ql=new ds,Mo=new O,So=new O,wo=new O,Ks=new O,Js=new O,Ar=new O,Ma=new O,Yl=new O,Zl=new O,Er=new O;function Sf(i,e,t,n,s){for(let r=0,o=i.length-3;r<=o;r+=3){Er.fromArray(i,r);let a=s.x*Math.abs(Er.x)+s.y*Math.abs(Er.y)+s.z*Math.abs(Er.z),l=e.dot(Er),c=t.dot(Er),h=n.dot(Er);if(Math.max(-Math.max(l,c,h),Math.min(l,c,h))>a)return!1}return!0}var An=new O,Kl=new qe,Hb=0,Ht=class extends Zi{constructor(e,t,n=!1){if(super(),Array.isArray(e))throw new TypeError("THREE.BufferAttribute: array should be a Typed Array.");this.isBufferAttribute=!0,Object.defineProperty(this,"id",{value:Hb++}),this.name="",this.array=e,this.itemSize=t,this.count=e!==void 0?e.length/t:0,this.normalized=n,this.usage=v0,this.updateRanges=[],this.gpuType=Ji,this.version=0,this._normalizationScale=e!==void 0?pd(e):void 0}onUploadCallback(){}set needsUpdate(e){e===!0&&this.version++}setUsage(e){return this.usage=e,this}addUpdateRange(e,t){this.updateRanges.push({start:e,count:t})}clearUpdateRanges(){this.updateRanges.length=0}copy(e){return this.name=e.name,this.array=new e.array.constructor(e.array),this.itemSize=e.itemSize,this.count=e.count,this.normalized=e.normalized,this.usage=e.usage,this.gpuType=e.gpuType,this._normalizationScale=e._normalizationScale,this}copyAt(e,t,n){e*=this.itemSize,n*=t.itemSize;for(let s=0,r=this.itemSize;s<r;s++)this.array[e+s]=t.array[n+s];return this}copyArray(e){return this.array.set(e),this}applyMatrix3(e){if(this.itemSize===2)for(let t=0,n=this.count;t<n;t++)Kl.fromBufferAttribute(this,t),Kl.applyMatrix3(e),this.setXY(t,Kl.x,Kl.y);else if(this.itemSize===3)for(let t=0,n=this.count;t<n;t++)An.fromBufferAttribute(this,t),An.applyMatrix3(e),this.setXYZ(t,An.x,An.y,An.z);return this}applyMatrix4(e){for(let t=0,n=this.count;t<n;t++)An.fromBufferAttribute(this,t),An.applyMatrix4(e),this.setXYZ(t,An.x,An.y,An.z);return this}applyNormalMatrix(e){for(let t=0,n=this.count;t<n;t++)An.fromBufferAttribute(this,t),An.applyNormalMatrix(e),this.setXYZ(t,An.x,An.y,An.z);return this}transformDirection(e){for(let t=0,n=this.count;t<n;t++)An.fromBufferAttribute(this,t),An.transformDirection(e),this.setXYZ(t,An.x,An.y,An.z);return this}set(e,t=0){return this.array.set(e,t),this}getComponent(e,t){let n=this.array[e*this.itemSize+t];return this.normalized&&(n=this._denormalize(n)),n}setComponent(e,t,n){return this.normalized&&(n=this._normalize(n)),this.array[e*this.itemSize+t]=n,this}getX(e){let t=this.array[e*this.itemSize];return this.normalized&&(t=this._denormalize(t)),t}setX(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize]=t,this}getY(e){let t=this.array[e*this.itemSize+1];return this.normalized&&(t=this._denormalize(t)),t}setY(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+1]=t,this}getZ(e){let t=this.array[e*this.itemSize+2];return this.normalized&&(t=this._denormalize(t)),t}setZ(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+2]=t,this}getW(e){let t=this.array[e*this.itemSize+3];return this.normalized&&(t=this._denormalize(t)),t}setW(e,t){return this.normalized&&(t=this._normalize(t)),this.array[e*this.itemSize+3]=t,this}setXY(e,t,n){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n)),this.array[e+0]=t,this.array[e+1]=n,this}setXYZ(e,t,n,s){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),s=this._normalize(s)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=s,this}setXYZW(e,t,n,s,r){return e*=this.itemSize,this.normalized&&(t=this._normalize(t),n=this._normalize(n),s=this._normalize(s),r=this._normalize(r)),this.array[e+0]=t,this.array[e+1]=n,this.array[e+2]=s,this.array[e+3]=r,this}onUpload(e){return this.onUploadCallback=e,this}clone(){return new this.constructor(this.array,this.itemSize).copy(this)}toJSON(){let e={itemSize:this.itemSize,type:this.array.constructor.name,array:Array.from(this.array),normalized:this.normalized};return e.name=this.name,e.usage=this.usage,e.gpuType=this.gpuType,e}dispose(){this.dispatchEvent({type:"dispose"})}_denormalize(e){let t=this._normalizationScale;return t!==void 0?Math.max(e/t,-1):A0(e,this.array)}_normalize(e){let t=this._normalizationScale;return t!==void 0?Math.round(e*t):E0(e,this.array)}};var Na=class extends Ht{constructor(e,t,n){super(new Uint16Array(e),t,n)}};var Ua=class extends Ht{constructor(e,t,n){super(new Uint32Array(e),t,n)}};var Nt=class extends Ht{constructor(e,t,n){super(new Float32Array(e),t,n)}},Gb=new ds,Sa=new O,wf=new O,Rr=class{constructor(e=new O,t=-1){this.isSphere=!0,this.center=e,this.radius=t}set(e,t){return this.center.copy(e),this.radius=t,this}setFromPoints(e,t){let n=this.center;t!==void 0?n.copy(t):Gb.setFromPoints(e).getCenter(n);let s=0;for(let r=0,o=e.length;r<o;r++)s=Math.max(s,n.distanceToSquared(e[r]));return this.radius=Math.sqrt(s),this}copy(e){return this.center.copy(e.center),this.radius=e.radius,this}isEmpty(){return this.radius<0}makeEmpty(){return this.center.set(0,0,0),this.radius=-1,this}containsPoint(e){return e.distanceToSquared(this.center)<=this.radius*this.radius}distanceToPoint(e){return e.distanceTo(this.center)-this.radius}intersectsSphere(e){let t=this.radius+e.radius;return e.center.distanceToSquared(this.center)<=t*t}intersectsBox(e){return e.intersectsSphere(this)}intersectsPlane(e){return Math.abs(e.distanceToPoint(this.center))<=this.radius}clampPoint(e,t){let n=this.center.distanceToSquared(e);return t.copy(e),n>this.radius*this.radius&&(t.sub(this.center).normalize(),t.multiplyScalar(this.radius).add(this.center)),t}getBoundingBox(e){return this.isEmpty()?(e.makeEmpty(),e):(e.set(this.center,this.center),e.expandByScalar(this.radius),e)}applyMatrix4(e){return this.center.applyMatrix4(e),this.radius=this.radius*e.getMaxScaleOnAxis(),this}translate(e){return this.center.add(e),this}expandByPoint(e){if(this.isEmpty())return this.center.copy(e),this.radius=0,this;Sa.subVectors(e,this.center);let t=Sa.lengthSq();if(t>this.radius*this.radius){let n=Math.sqrt(t),s=(n-this.radius)*.5;this.center.addScaledVector(Sa,s/n),this.radius+=s}return this}union(e){return e.isEmpty()?this:this.isEmpty()?(this.copy(e),this):(this.center.equals(e.center)===!0?this.radius=Math.max(this.radius,e.radius):(wf.subVectors(e.center,this.center).setLength(e.radius),this.expandByPoint(Sa.copy(e.center).add(wf)),this.expandByPoint(Sa.copy(e.center).sub(wf))),this)}equals(e){return e.center.equals(this.center)&&e.radius===this.radius}clone(){return new this.constructor().copy(this)}toJSON(){return{radius:this.radius,center:this.center.toArray()}}fromJSON(e){return this.radius=e.radius,this.center.fromArray(e.center),this}},Wb=0,Oi=new Vt,Af=new Qn,Ao=new O,Ei=new ds,wa=new ds,kn=new O,ct=class i extends Zi{constructor(){super(),this.isBufferGeometry=!0,Object.defineProperty(this,"id",{value:Wb++}),this.uuid=Xo(),this.name="",this.type="BufferGeometry",this.index=null,this.indirect=null,this.indirectOffset=0,this.attributes={},this.morphAttributes={},this.morphTargetsRelative=!1,this.groups=[],this.boundingBox=null,this.boundingSphere=null,this.drawRange={start:0,count:1/0},this.userData={},this._transformed=!1}getIndex(){return this.index}setIndex(e){return Array.isArray(e)?this.index=new(mb(e)?Ua:Na)(e,1):this.index=e,this}setIndirect(e,t=0){return this.indirect=e,this.indirectOffset=t,this}getIndirect(){return this.indirect}getAttribute(e){return this.attributes[e]}setAttribute(e,t){return this.attributes[e]=t,this}deleteAttribute(e){return delete this.attributes[e],this}hasAttribute(e){return this.attributes[e]!==void 0}addGroup(e,t,n=0){this.groups.push({start:e,count:t,materialIndex:n})}clearGroups(){this.groups=[]}setDrawRange(e,t){this.drawRange.start=e,this.drawRange.count=t}applyMatrix4(e){let t=this.attributes.position;t!==void 0&&(t.applyMatrix4(e),t.needsUpdate=!0);let n=this.attributes.normal;if(n!==void 0){let r=new nt().getNormalMatrix(e);n.applyNormalMatrix(r),n.needsUpdate=!0}let s=this.attributes.tangent;return s!==void 0&&(s.transformDirection(e),s.needsUpdate=!0),this.boundingBox!==null&&this.computeBoundingBox(),this.boundingSphere!==null&&this.computeBoundingSphere(),this._transformed=!0,this}applyQuaternion(e){return Oi.makeRotationFromQuaternion(e),this.applyMatrix4(Oi),this}rotateX(e){return Oi.makeRotationX(e),this.applyMatrix4(Oi),this}rotateY(e){return Oi.makeRotationY(e),this.applyMatrix4(Oi),this}rotateZ(e){return Oi.makeRotationZ(e),this.applyMatrix4(Oi),this}translate(e,t,n){return Oi.makeTranslation(e,t,n),this.applyMatrix4(Oi),this}scale(e,t,n){return Oi.makeScale(e,t,n),this.applyMatrix4(Oi),this}lookAt(e){return Af.lookAt(e),Af.updateMatrix(),this.applyMatrix4(Af.matrix),this}center(){return this.computeBoundingBox(),this.boundingBox.getCenter(Ao).negate(),this.translate(Ao.x,Ao.y,Ao.z),this}setFromPoints(e){let t=this.getAttribute("position");if(t===void 0){let n=[];for(let s=0,r=e.length;s<r;s++){let o=e[s];n.push(o.x,o.y,o.z||0)}this.setAttribute("position",new Nt(n,3))}else{let n=Math.min(e.length,t.count);for(let s=0;s<n;s++){let r=e[s];t.setXYZ(s,r.x,r.y,r.z||0)}e.length>t.count&&Ye("BufferGeometry: Buffer size too small for points data. Use .dispose() and create a new geometry."),t.needsUpdate=!0}return this}computeBoundingBox(){this.boundingBox===null&&(this.boundingBox=new ds);let e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){et("BufferGeometry.computeBoundingBox(): GLBufferAttribute requires a manual bounding box.",this),this.boundingBox.set(new O(-1/0,-1/0,-1/0),new O(1/0,1/0,1/0));return}if(e!==void 0){if(this.boundingBox.setFromBufferAttribute(e),t)for(let n=0,s=t.length;n<s;n++){let r=t[n];Ei.setFromBufferAttribute(r),this.morphTargetsRelative?(kn.addVectors(this.boundingBox.min,Ei.min),this.boundingBox.expandByPoint(kn),kn.addVectors(this.boundingBox.max,Ei.max),this.boundingBox.expandByPoint(kn)):(this.boundingBox.expandByPoint(Ei.min),this.boundingBox.expandByPoint(Ei.max))}}else this.boundingBox.makeEmpty();(isNaN(this.boundingBox.min.x)||isNaN(this.boundingBox.min.y)||isNaN(this.boundingBox.min.z))&&et('BufferGeometry.computeBoundingBox(): Computed min/max have NaN values. The "position" attribute is likely to have NaN values.',this)}computeBoundingSphere(){this.boundingSphere===null&&(this.boundingSphere=new Rr);let e=this.attributes.position,t=this.morphAttributes.position;if(e&&e.isGLBufferAttribute){et("BufferGeometry.computeBoundingSphere(): GLBufferAttribute requires a manual bounding sphere.",this),this.boundingSphere.set(new O,1/0);return}if(e){let n=this.boundingSphere.center;if(Ei.setFromBufferAttribute(e),t)for(let r=0,o=t.length;r<o;r++){let a=t[r];wa.setFromBufferAttribute(a),this.morphTargetsRelative?(kn.addVectors(Ei.min,wa.min),Ei.expandByPoint(kn),kn.addVectors(Ei.max,wa.max),Ei.expandByPoint(kn)):(Ei.expandByPoint(wa.min),Ei.expandByPoint(wa.max))}Ei.getCenter(n);let s=0;for(let r=0,o=e.count;r<o;r++)kn.fromBufferAttribute(e,r),s=Math.max(s,n.distanceToSquared(kn));if(t)for(let r=0,o=t.length;r<o;r++){let a=t[r],l=this.morphTargetsRelative;for(let c=0,h=a.count;c<h;c++)kn.fromBufferAttribute(a,c),l&&(Ao.fromBufferAttribute(e,c),kn.add(Ao)),s=Math.max(s,n.distanceToSquared(kn))}this.boundingSphere.radius=Math.sqrt(s),isNaN(this.boundingSphere.radius)&&et('BufferGeometry.computeBoundingSphere(): Computed radius is NaN. The "position" attribute is likely to have NaN values.',this)}}computeTangents(){let e=this.index,t=this.attributes;if(e===null||t.position===void 0||t.normal===void 0||t.uv===void 0){et("BufferGeometry: .computeTangents() failed. Missing required attributes (index, position, normal or uv)");return}let n=t.position,s=t.normal,r=t.uv,o=this.getAttribute("tangent");(o===void 0||o.count!==n.count)&&(o=new Ht(new Float32Array(4*n.count),4),this.setAttribute("tangent",o));let a=[],l=[],c=new Uint8Array(n.count);for(let D=0;D<n.count;D++)a[D]=new O,l[D]=new O;let h=new O,u=new O,f=new O,p=new qe,g=new qe,x=new qe,m=new O,d=new O;function y(D,I,L){c[D]=c[I]=c[L]=1,h.fromBufferAttribute(n,D),u.fromBufferAttribute(n,I),f.fromBufferAttribute(n,L),p.fromBufferAttribute(r,D),g.fromBufferAttribute(r,I),x.fromBufferAttribute(r,L),u.sub(h),f.sub(h),g.sub(p),x.sub(p);let k=1/(g.x*x.y-x.x*g.y);isFinite(k)&&(m.copy(u).multiplyScalar(x.y).addScaledVector(f,-g.y).multiplyScalar(k),d.copy(f).multiplyScalar(g.x).addScaledVector(u,-x.x).multiplyScalar(k),a[D].add(m),a[I].add(m),a[L].add(m),l[D].add(d),l[I].add(d),l[L].add(d))}let w=this.groups;w.length===0&&(w=[{start:0,count:e.count}]);for(let D=0,I=w.length;D<I;++D){let L=w[D],k=L.start,V=L.count;for(let R=k,U=k+V;R<U;R+=3)y(e.getX(R+0),e.getX(R+1),e.getX(R+2))}let v=new O,E=new O,S=new O,_=new O;function M(D){S.fromBufferAttribute(s,D),_.copy(S);let I=a[D];v.copy(I),v.sub(S.multiplyScalar(S.dot(I))).normalize(),E.crossVectors(_,I);let k=E.dot(l[D])<0?-1:1;o.setXYZW(D,v.x,v.y,v.z,k)}for(let D=0,I=n.count;D<I;++D)c[D]&&M(D);this._transformed=!0}computeVertexNormals(){let e=this.index,t=this.getAttribute("position");if(t!==void 0){let n=this.getAttribute("normal");if(n===void 0||n.count!==t.count)n=new Ht(new Float32Array(t.count*3),3),this.setAttribute("normal",n);else for(let f=0,p=n.count;f<p;f++)n.setXYZ(f,0,0,0);let s=new O,r=new O,o=new O,a=new O,l=new O,c=new O,h=new O,u=new O;if(e)for(let f=0,p=e.count;f<p;f+=3){let g=e.getX(f+0),x=e.getX(f+1),m=e.getX(f+2);s.fromBufferAttribute(t,g),r.fromBufferAttribute(t,x),o.fromBufferAttribute(t,m),h.subVectors(o,r),u.subVectors(s,r),h.cross(u),a.fromBufferAttribute(n,g),l.fromBufferAttribute(n,x),c.fromBufferAttribute(n,m),a.add(h),l.add(h),c.add(h),n.setXYZ(g,a.x,a.y,a.z),n.setXYZ(x,l.x,l.y,l.z),n.setXYZ(m,c.x,c.y,c.z)}else for(let f=0,p=t.count;f<p;f+=3)s.fromBufferAttribute(t,f+0),r.fromBufferAttribute(t,f+1),o.fromBufferAttribute(t,f+2),h.subVectors(o,r),u.subVectors(s,r),h.cross(u),n.setXYZ(f+0,h.x,h.y,h.z),n.setXYZ(f+1,h.x,h.y,h.z),n.setXYZ(f+2,h.x,h.y,h.z);this.normalizeNormals(),n.needsUpdate=!0}}normalizeNormals(){let e=this.attributes.normal;for(let t=0,n=e.count;t<n;t++)kn.fromBufferAttribute(e,t),kn.normalize(),e.setXYZ(t,kn.x,kn.y,kn.z)}toNonIndexed(){function e(a,l){let c=a.array,h=a.itemSize,u=a.normalized,f=new c.constructor(l.length*h),p=0,g=0;for(let x=0,m=l.length;x<m;x++){a.isInterleavedBufferAttribute?p=l[x]*a.data.stride+a.offset:p=l[x]*h;for(let d=0;d<h;d++)f[g++]=c[p++]}return new Ht(f,h,u)}if(this.index===null)return Ye("BufferGeometry.toNonIndexed(): BufferGeometry is already non-indexed."),this;let t=new i,n=this.index.array,s=this.attributes;for(let a in s){let l=s[a],c=e(l,n);t.setAttribute(a,c)}let r=this.morphAttributes;for(let a in r){let l=[],c=r[a];for(let h=0,u=c.length;h<u;h++){let f=c[h],p=e(f,n);l.push(p)}t.morphAttributes[a]=l}t.morphTargetsRelative=this.morphTargetsRelative;let o=this.groups;for(let a=0,l=o.length;a<l;a++){let c=o[a];t.addGroup(c.start,c.count,c.materialIndex)}return t}toJSON(){let e={metadata:{version:4.7,type:"BufferGeometry",generator:"BufferGeometry.toJSON"}};if(e.uuid=this.uuid,e.type=this.parameters!==void 0&&this._transformed===!0?"BufferGeometry":this.type,e.name=this.name,Object.keys(this.userData).length>0&&(e.userData=this.userData),this.parameters!==void 0&&this._transformed!==!0){let l=this.parameters;for(let c in l)l[c]!==void 0&&(e[c]=l[c]);return e}e.data={attributes:{}};let t=this.index;t!==null&&(e.data.index={type:t.array.constructor.name,array:Array.prototype.slice.call(t.array)});let n=this.attributes;for(let l in n){let c=n[l];e.data.attributes[l]=c.toJSON(e.data)}let s={},r=!1;for(let l in this.morphAttributes){let c=this.morphAttributes[l],h=[];for(let u=0,f=c.length;u<f;u++){let p=c[u];h.push(p.toJSON(e.data))}h.length>0&&(s[l]=h,r=!0)}r&&(e.data.morphAttributes=s,e.data.morphTargetsRelative=this.morphTargetsRelative);let o=this.groups;o.length>0&&(e.data.groups=JSON.parse(JSON.stringify(o)));let a=this.boundingSphere;return a!==null&&(e.data.boundingSphere=a.toJSON()),e}clone(){return new this.constructor().copy(this)}copy(e){this.index=null,this.attributes={},this.morphAttributes={},this.groups=[],this.boundingBox=null,this.boundingSphere=null;let t={};this.name=e.name;let n=e.index;n!==null&&this.setIndex(n.clone());let s=e.attributes;for(let c in s){let h=s[c];this.setAttribute(c,h.clone(t))}let r=e.morphAttributes;for(let c in r){let h=[],u=r[c];for(let f=0,p=u.length;f<p;f++)h.push(u[f].clone(t));this.morphAttributes[c]=h}this.morphTargetsRelative=e.morphTargetsRelative;let o=e.groups;for(let c=0,h=o.length;c<h;c++){let u=o[c];this.addGroup(u.start,u.count,u.materialIndex)}let a=e.boundingBox;a!==null&&(this.boundingBox=a.clone());let l=e.boundingSphere;return l!==null&&(this.boundingSphere=l.clone()),this.drawRange.start=e.drawRange.start,this.drawRange.count=e.drawRange.count,this.userData=e.userData,this._transformed=e._transformed,this}dispose(){this.dispatchEvent({type:"dispose"})}};var Ef=new O,Xb=new O,$b=new nt,jn=class{constructor(e=new O(1,0,0),t=0){this.isPlane=!0,this.normal=e,this.constant=t}set(e,t){return this.normal.copy(e),this.constant=t,this}setComponents(e,t,n,s){return this.normal.set(e,t,n),this.constant=s,this}setFromNormalAndCoplanarPoint(e,t){return this.normal.copy(e),this.constant=-t.dot(this.normal),this}setFromCoplanarPoints(e,t,n){let s=Ef.subVectors(n,t).cross(Xb.subVectors(e,t)).normalize();return this.setFromNormalAndCoplanarPoint(s,e),this}copy(e){return this.normal.copy(e.normal),this.constant=e.constant,this}normalize(){let e=1/this.normal.length();return this.normal.multiplyScalar(e),this.constant*=e,this}negate(){return this.constant*=-1,this.normal.negate(),this}distanceToPoint(e){return this.normal.dot(e)+this.constant}distanceToSphere(e){return this.distanceToPoint(e.center)-e.radius}projectPoint(e,t){return t.copy(e).addScaledVector(this.normal,-this.distanceToPoint(e))}intersectLine(e,t,n=!0){let s=e.delta(Ef),r=this.normal.dot(s);if(r===0)return this.distanceToPoint(e.start)===0?t.copy(e.start):null;let o=-(e.start.dot(this.normal)+this.constant)/r;return n===!0&&(o<0||o>1)?null:t.copy(e.start).addScaledVector(s,o)}intersectsLine(e){let t=this.distanceToPoint(e.start),n=this.distanceToPoint(e.end);return t<0&&n>0||n<0&&t>0}intersectsBox(e){return e.intersectsPlane(this)}intersectsSphere(e){return e.intersectsPlane(this)}coplanarPoint(e){return e.copy(this.normal).multiplyScalar(-this.constant)}applyMatrix4(e,t){let n=t||$b.getNormalMatrix(e),s=this.coplanarPoint(Ef).applyMatrix4(e),r=this.normal.applyMatrix3(n).normalize();return this.constant=-s.dot(r),this}translate(e){return this.constant-=e.dot(this.normal),this}equals(e){return e.normal.equals(this.normal)&&e.constant===this.constant}clone(){return new this.constructor().copy(this)}toJSON(){return{normal:this.normal.toArray(),constant:this.constant}}fromJSON(e){return this.normal.fromArray(e.normal),this.constant=e.constant,this}},qb=0,Ns=class extends Zi{constructor(){super(),this.isMaterial=!0,Object.defineProperty(this,"id",{value:qb++}),this.uuid=Xo(),this.name="",this.type="Material",this.blending=Vo,this.side=cr,this.vertexColors=!1,this.opacity=1,this.transparent=!1,this.alphaHash=!1,this.blendSrc=Wf,this.blendDst=Xf,this.blendEquation=Nr,this.blendSrcAlpha=null,this.blendDstAlpha=null,this.blendEquationAlpha=null,this.blendColor=new dt(0,0,0),this.blendAlpha=0,this.depthFunc=Po,this.depthTest=!0,this.depthWrite=!0,this.stencilWriteMask=255,this.stencilFunc=p0,this.stencilRef=0,this.stencilFuncMask=255,this.stencilFail=gc,this.stencilZFail=gc,this.stencilZPass=gc,this.stencilWrite=!1,this.clippingPlanes=null,this.clipIntersection=!1,this.clipShadows=!1,this.shadowSide=null,this.colorWrite=!0,this.precision=null,this.polygonOffset=!1,this.polygonOffsetFactor=0,this.polygonOffsetUnits=0,this.dithering=!1,this.alphaToCoverage=!1,this.premultipliedAlpha=!1,this.forceSinglePass=!1,this.allowOverride=!0,this.visible=!0,this.toneMapped=!0,this.userData={},this.version=0,this._alphaTest=0}get alphaTest(){return this._alphaTest}set alphaTest(e){this._alphaTest>0!=e>0&&this.version++,this._alphaTest=e}onBeforeRender(){}onBeforeCompile(){}customProgramCacheKey(){return this.onBeforeCompile.toString()}setValues(e){if(e!==void 0)for(let t in e){let n=e[t];if(n===void 0){Ye(`Material: parameter '${t}' has value of undefined.`);continue}let s=this[t];if(s===void 0){Ye(`Material: '${t}' is not a property of THREE.${this.type}.`);continue}s&&s.isColor?s.set(n):s&&s.isVector2&&n&&n.isVector2||s&&s.isEuler&&n&&n.isEuler||s&&s.isVector3&&n&&n.isVector3?s.copy(n):this[t]=n}}toJSON(e){let t=e===void 0||typeof e=="string";t&&(e={textures:{},images:{}});let n={metadata:{version:4.7,type:"Material",generator:"Material.toJSON"}};n.uuid=this.uuid,n.type=this.type,n.blending=this.blending,n.side=this.side,n.shadowSide=this.shadowSide,n.vertexColors=this.vertexColors,n.opacity=this.opacity,n.transparent=this.transparent,n.blendSrc=this.blendSrc,n.blendDst=this.blendDst,n.blendEquation=this.blendEquation,n.blendSrcAlpha=this.blendSrcAlpha,n.blendDstAlpha=this.blendDstAlpha,n.blendEquationAlpha=this.blendEquationAlpha,n.blendColor=this.blendColor.getHex(),n.blendAlpha=this.blendAlpha,n.depthFunc=this.depthFunc,n.depthTest=this.depthTest,n.depthWrite=this.depthWrite,n.colorWrite=this.colorWrite,n.clipIntersection=this.clipIntersection,n.clipShadows=this.clipShadows,n.stencilWriteMask=this.stencilWriteMask,n.stencilFunc=this.stencilFunc,n.stencilRef=this.stencilRef,n.stencilFuncMask=this.stencilFuncMask,n.stencilFail=this.stencilFail,n.stencilZFail=this.stencilZFail,n.stencilZPass=this.stencilZPass,n.stencilWrite=this.stencilWrite,n.polygonOffset=this.polygonOffset,n.polygonOffsetFactor=this.polygonOffsetFactor,n.polygonOffsetUnits=this.polygonOffsetUnits,n.dithering=this.dithering,n.alphaTest=this.alphaTest,n.alphaHash=this.alphaHash,n.alphaToCoverage=this.alphaToCoverage,n.premultipliedAlpha=this.premultipliedAlpha,n.forceSinglePass=this.forceSinglePass,n.allowOverride=this.allowOverride,n.visible=this.visible,n.toneMapped=this.toneMapped,n.name=this.name,this.color&&this.color.isColor&&(n.color=this.color.getHex()),this.roughness!==void 0&&(n.roughness=this.roughness),this.metalness!==void 0&&(n.metalness=this.metalness),this.sheen!==void 0&&(n.sheen=this.sheen),this.sheenColor&&this.sheenColor.isColor&&(n.sheenColor=this.sheenColor.getHex()),this.sheenRoughness!==void 0&&(n.sheenRoughness=this.sheenRoughness),this.emissive&&this.emissive.isColor&&(n.emissive=this.emissive.getHex()),this.emissiveIntensity!==void 0&&(n.emissiveIntensity=this.emissiveIntensity),this.specular&&this.specular.isColor&&(n.specular=this.specular.getHex()),this.specularIntensity!==void 0&&(n.specularIntensity=this.specularIntensity),this.specularColor&&this.specularColor.isColor&&(n.specularColor=this.specularColor.getHex()),this.shininess!==void 0&&(n.shininess=this.shininess),this.clearcoat!==void 0&&(n.clearcoat=this.clearcoat),this.clearcoatRoughness!==void 0&&(n.clearcoatRoughness=this.clearcoatRoughness),this.diffuseRoughness!==void 0&&(n.diffuseRoughness=this.diffuseRoughness),this.diffuseRoughnessMap&&this.diffuseRoughnessMap.isTexture&&(n.diffuseRoughnessMap=this.diffuseRoughnessMap.toJSON(e).uuid),this.clearcoatMap&&this.clearcoatMap.isTexture&&(n.clearcoatMap=this.clearcoatMap.toJSON(e).uuid),this.clearcoatRoughnessMap&&this.clearcoatRoughnessMap.isTexture&&(n.clearcoatRoughnessMap=this.clearcoatRoughnessMap.toJSON(e).uuid),this.clearcoatNormalMap&&this.clearcoatNormalMap.isTexture&&(n.clearcoatNormalMap=this.clearcoatNormalMap.toJSON(e).uuid,n.clearcoatNormalScale=this.clearcoatNormalScale.toArray()),this.sheenColorMap&&this.sheenColorMap.isTexture&&(n.sheenColorMap=this.sheenColorMap.toJSON(e).uuid),this.sheenRoughnessMap&&this.sheenRoughnessMap.isTexture&&(n.sheenRoughnessMap=this.sheenRoughnessMap.toJSON(e).uuid),this.dispersion!==void 0&&(n.dispersion=this.dispersion),this.retroreflectivity!==void 0&&(n.retroreflectivity=this.retroreflectivity),this.iridescence!==void 0&&(n.iridescence=this.iridescence),this.iridescenceIOR!==void 0&&(n.iridescenceIOR=this.iridescenceIOR),this.iridescenceThicknessMinimum!==void 0&&(n.iridescenceThicknessMinimum=this.iridescenceThicknessMinimum),this.iridescenceThicknessMaximum!==void 0&&(n.iridescenceThicknessMaximum=this.iridescenceThicknessMaximum),this.iridescenceMap&&this.iridescenceMap.isTexture&&(n.iridescenceMap=this.iridescenceMap.toJSON(e).uuid),this.iridescenceThicknessMap&&this.iridescenceThicknessMap.isTexture&&(n.iridescenceThicknessMap=this.iridescenceThicknessMap.toJSON(e).uuid),this.anisotropy!==void 0&&(n.anisotropy=this.anisotropy),this.anisotropyRotation!==void 0&&(n.anisotropyRotation=this.anisotropyRotation),this.anisotropyMap&&this.anisotropyMap.isTexture&&(n.anisotropyMap=this.anisotropyMap.toJSON(e).uuid),this.map&&this.map.isTexture&&(n.map=this.map.toJSON(e).uuid),this.matcap&&this.matcap.isTexture&&(n.matcap=this.matcap.toJSON(e).uuid),this.alphaMap&&this.alphaMap.isTexture&&(n.alphaMap=this.alphaMap.toJSON(e).uuid),this.lightMap&&this.lightMap.isTexture&&(n.lightMap=this.lightMap.toJSON(e).uuid,n.lightMapIntensity=this.lightMapIntensity),this.aoMap&&this.aoMap.isTexture&&(n.aoMap=this.aoMap.toJSON(e).uuid,n.aoMapIntensity=this.aoMapIntensity),this.bumpMap&&this.bumpMap.isTexture&&(n.bumpMap=this.bumpMap.toJSON(e).uuid,n.bumpScale=this.bumpScale),this.normalMap&&this.normalMap.isTexture&&(n.normalMap=this.normalMap.toJSON(e).uuid,n.normalMapType=this.normalMapType,n.normalScale=this.normalScale.toArray()),this.displacementMap&&this.displacementMap.isTexture&&(n.displacementMap=this.displacementMap.toJSON(e).uuid,n.displacementScale=this.displacementScale,n.displacementBias=this.displacementBias),this.roughnessMap&&this.roughnessMap.isTexture&&(n.roughnessMap=this.roughnessMap.toJSON(e).uuid),this.metalnessMap&&this.metalnessMap.isTexture&&(n.metalnessMap=this.metalnessMap.toJSON(e).uuid),this.emissiveMap&&this.emissiveMap.isTexture&&(n.emissiveMap=this.emissiveMap.toJSON(e).uuid),this.specularMap&&this.specularMap.isTexture&&(n.specularMap=this.specularMap.toJSON(e).uuid),this.specularIntensityMap&&this.specularIntensityMap.isTexture&&(n.specularIntensityMap=this.specularIntensityMap.toJSON(e).uuid),this.specularColorMap&&this.specularColorMap.isTexture&&(n.specularColorMap=this.specularColorMap.toJSON(e).uuid),this.envMap&&this.envMap.isTexture&&(n.envMap=this.envMap.toJSON(e).uuid,this.combine!==void 0&&(n.combine=this.combine)),this.envMapRotation!==void 0&&(n.envMapRotation=this.envMapRotation.toArray()),this.envMapIntensity!==void 0&&(n.envMapIntensity=this.envMapIntensity),this.reflectivity!==void 0&&(n.reflectivity=this.reflectivity),this.refractionRatio!==void 0&&(n.refractionRatio=this.refractionRatio),this.gradientMap&&this.gradientMap.isTexture&&(n.gradientMap=this.gradientMap.toJSON(e).uuid),this.transmission!==void 0&&(n.transmission=this.transmission),this.transmissionMap&&this.transmissionMap.isTexture&&(n.transmissionMap=this.transmissionMap.toJSON(e).uuid),this.thickness!==void 0&&(n.thickness=this.thickness),this.thicknessMap&&this.thicknessMap.isTexture&&(n.thicknessMap=this.thicknessMap.toJSON(e).uuid),this.attenuationDistance!==void 0&&(n.attenuationDistance=this.attenuationDistance),this.attenuationColor!==void 0&&(n.attenuationColor=this.attenuationColor.getHex()),this.size!==void 0&&(n.size=this.size),this.sizeAttenuation!==void 0&&(n.sizeAttenuation=this.sizeAttenuation),Array.isArray(this.clippingPlanes)&&this.clippingPlanes.length>0&&(n.clippingPlanes=this.clippingPlanes.map(r=>r.toJSON())),this.rotation!==void 0&&(n.rotation=this.rotation),this.depthPacking!==void 0&&(n.depthPacking=this.depthPacking),this.linewidth!==void 0&&(n.linewidth=this.linewidth),this.linecap!==void 0&&(n.linecap=this.linecap),this.linejoin!==void 0&&(n.linejoin=this.linejoin),this.dashSize!==void 0&&(n.dashSize=this.dashSize),this.gapSize!==void 0&&(n.gapSize=this.gapSize),this.scale!==void 0&&(n.scale=this.scale),this.wireframe!==void 0&&(n.wireframe=this.wireframe),this.wireframeLinewidth!==void 0&&(n.wireframeLinewidth=this.wireframeLinewidth),this.wireframeLinecap!==void 0&&(n.wireframeLinecap=this.wireframeLinecap),this.wireframeLinejoin!==void 0&&(n.wireframeLinejoin=this.wireframeLinejoin),this.flatShading!==void 0&&(n.flatShading=this.flatShading),this.fog!==void 0&&(n.fog=this.fog),Object.keys(this.userData).length>0&&(n.userData=this.userData);function s(r){let o=[];for(let a in r){let l=r[a];delete l.metadata,o.push(l)}return o}if(t){let r=s(e.textures),o=s(e.images);r.length>0&&(n.textures=r),o.length>0&&(n.images=o)}return n}fromJSON(e,t){if(e.uuid!==void 0&&(this.uuid=e.uuid),e.name!==void 0&&(this.name=e.name),e.color!==void 0&&this.color!==void 0&&this.color.setHex(e.color),e.roughness!==void 0&&(this.roughness=e.roughness),e.metalness!==void 0&&(this.metalness=e.metalness),e.sheen!==void 0&&(this.sheen=e.sheen),e.sheenColor!==void 0&&(this.sheenColor=new dt().setHex(e.sheenColor)),e.sheenRoughness!==void 0&&(this.sheenRoughness=e.sheenRoughness),e.emissive!==void 0&&this.emissive!==void 0&&this.emissive.setHex(e.emissive),e.specular!==void 0&&this.specular!==void 0&&this.specular.setHex(e.specular),e.specularIntensity!==void 0&&(this.specularIntensity=e.specularIntensity),e.specularColor!==void 0&&this.specularColor!==void 0&&this.specularColor.setHex(e.specularColor),e.shininess!==void 0&&(this.shininess=e.shininess),e.clearcoat!==void 0&&(this.clearcoat=e.clearcoat),e.clearcoatRoughness!==void 0&&(this.clearcoatRoughness=e.clearcoatRoughness),e.diffuseRoughness!==void 0&&(this.diffuseRoughness=e.diffuseRoughness),e.dispersion!==void 0&&(this.dispersion=e.dispersion),e.retroreflectivity!==void 0&&(this.retroreflectivity=e.retroreflectivity),e.iridescence!==void 0&&(this.iridescence=e.iridescence),e.iridescenceIOR!==void 0&&(this.iridescenceIOR=e.iridescenceIOR),e.iridescenceThicknessMinimum!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessMinimum),e.iridescenceThicknessMaximum!==void 0&&(this.iridescenceThicknessMaximum=e.iridescenceThicknessMaximum),e.iridescenceThicknessRange!==void 0&&(this.iridescenceThicknessMinimum=e.iridescenceThicknessRange[0],this.iridescenceThicknessMaximum=e.iridescenceThicknessRange[1]),e.transmission!==void 0&&(this.transmission=e.transmission),e.thickness!==void 0&&(this.thickness=e.thickness),e.attenuationDistance!==void 0&&(this.attenuationDistance=e.attenuationDistance),e.attenuationColor!==void 0&&this.attenuationColor!==void 0&&this.attenuationColor.setHex(e.attenuationColor),e.anisotropy!==void 0&&(this.anisotropy=e.anisotropy),e.anisotropyRotation!==void 0&&(this.anisotropyRotation=e.anisotropyRotation),e.fog!==void 0&&(this.fog=e.fog),e.flatShading!==void 0&&(this.flatShading=e.flatShading),e.blending!==void 0&&(this.blending=e.blending),e.combine!==void 0&&(this.combine=e.combine),e.side!==void 0&&(this.side=e.side),e.shadowSide!==void 0&&(this.shadowSide=e.shadowSide),e.opacity!==void 0&&(this.opacity=e.opacity),e.transparent!==void 0&&(this.transparent=e.transparent),e.alphaTest!==void 0&&(this.alphaTest=e.alphaTest),e.alphaHash!==void 0&&(this.alphaHash=e.alphaHash),e.depthFunc!==void 0&&(this.depthFunc=e.depthFunc),e.depthTest!==void 0&&(this.depthTest=e.depthTest),e.depthWrite!==void 0&&(this.depthWrite=e.depthWrite),e.colorWrite!==void 0&&(this.colorWrite=e.colorWrite),e.clippingPlanes!==void 0&&(this.clippingPlanes=e.clippingPlanes.map(n=>new jn().fromJSON(n))),e.clipIntersection!==void 0&&(this.clipIntersection=e.clipIntersection),e.clipShadows!==void 0&&(this.clipShadows=e.clipShadows),e.depthPacking!==void 0&&(this.depthPacking=e.depthPacking),e.blendSrc!==void 0&&(this.blendSrc=e.blendSrc),e.blendDst!==void 0&&(this.blendDst=e.blendDst),e.blendEquation!==void 0&&(this.blendEquation=e.blendEquation),e.blendSrcAlpha!==void 0&&(this.blendSrcAlpha=e.blendSrcAlpha),e.blendDstAlpha!==void 0&&(this.blendDstAlpha=e.blendDstAlpha),e.blendEquationAlpha!==void 0&&(this.blendEquationAlpha=e.blendEquationAlpha),e.blendColor!==void 0&&this.blendColor!==void 0&&this.blendColor.setHex(e.blendColor),e.blendAlpha!==void 0&&(this.blendAlpha=e.blendAlpha),e.stencilWriteMask!==void 0&&(this.stencilWriteMask=e.stencilWriteMask),e.stencilFunc!==void 0&&(this.stencilFunc=e.stencilFunc),e.stencilRef!==void 0&&(this.stencilRef=e.stencilRef),e.stencilFuncMask!==void 0&&(this.stencilFuncMask=e.stencilFuncMask),e.stencilFail!==void 0&&(this.stencilFail=e.stencilFail),e.stencilZFail!==void 0&&(this.stencilZFail=e.stencilZFail),e.stencilZPass!==void 0&&(this.stencilZPass=e.stencilZPass),e.stencilWrite!==void 0&&(this.stencilWrite=e.stencilWrite),e.wireframe!==void 0&&(this.wireframe=e.wireframe),e.wireframeLinewidth!==void 0&&(this.wireframeLinewidth=e.wireframeLinewidth),e.wireframeLinecap!==void 0&&(this.wireframeLinecap=e.wireframeLinecap),e.wireframeLinejoin!==void 0&&(this.wireframeLinejoin=e.wireframeLinejoin),e.rotation!==void 0&&(this.rotation=e.rotation),e.linewidth!==void 0&&(this.linewidth=e.linewidth),e.linecap!==void 0&&(this.linecap=e.linecap),e.linejoin!==void 0&&(this.linejoin=e.linejoin),e.dashSize!==void 0&&(this.dashSize=e.dashSize),e.gapSize!==void 0&&(this.gapSize=e.gapSize),e.scale!==void 0&&(this.scale=e.scale),e.polygonOffset!==void 0&&(this.polygonOffset=e.polygonOffset),e.polygonOffsetFactor!==void 0&&(this.polygonOffsetFactor=e.polygonOffsetFactor),e.polygonOffsetUnits!==void 0&&(this.polygonOffsetUnits=e.polygonOffsetUnits),e.dithering!==void 0&&(this.dithering=e.dithering),e.alphaToCoverage!==void 0&&(this.alphaToCoverage=e.alphaToCoverage),e.premultipliedAlpha!==void 0&&(this.premultipliedAlpha=e.premultipliedAlpha),e.forceSinglePass!==void 0&&(this.forceSinglePass=e.forceSinglePass),e.allowOverride!==void 0&&(this.allowOverride=e.allowOverride),e.visible!==void 0&&(this.visible=e.visible),e.toneMapped!==void 0&&(this.toneMapped=e.toneMapped),e.userData!==void 0&&(this.userData=e.userData),e.vertexColors!==void 0&&(typeof e.vertexColors=="number"?this.vertexColors=e.vertexColors>0:this.vertexColors=e.vertexColors),e.size!==void 0&&(this.size=e.size),e.sizeAttenuation!==void 0&&(this.sizeAttenuation=e.sizeAttenuation),e.map!==void 0&&(this.map=t[e.map]||null),e.matcap!==void 0&&(this.matcap=t[e.matcap]||null),e.alphaMap!==void 0&&(this.alphaMap=t[e.alphaMap]||null),e.bumpMap!==void 0&&(this.bumpMap=t[e.bumpMap]||null),e.bumpScale!==void 0&&(this.bumpScale=e.bumpScale),e.normalMap!==void 0&&(this.normalMap=t[e.normalMap]||null),e.normalMapType!==void 0&&(this.normalMapType=e.normalMapType),e.normalScale!==void 0){let n=e.normalScale;Array.isArray(n)===!1&&(n=[n,n]),this.normalScale=new qe().fromArray(n)}return e.displacementMap!==void 0&&(this.displacementMap=t[e.displacementMap]||null),e.displacementScale!==void 0&&(this.displacementScale=e.displacementScale),e.displacementBias!==void 0&&(this.displacementBias=e.displacementBias),e.roughnessMap!==void 0&&(this.roughnessMap=t[e.roughnessMap]||null),e.metalnessMap!==void 0&&(this.metalnessMap=t[e.metalnessMap]||null),e.emissiveMap!==void 0&&(this.emissiveMap=t[e.emissiveMap]||null),e.emissiveIntensity!==void 0&&(this.emissiveIntensity=e.emissiveIntensity),e.specularMap!==void 0&&(this.specularMap=t[e.specularMap]||null),e.specularIntensityMap!==void 0&&(this.specularIntensityMap=t[e.specularIntensityMap]||null),e.specularColorMap!==void 0&&(this.specularColorMap=t[e.specularColorMap]||null),e.envMap!==void 0&&(this.envMap=t[e.envMap]||null),e.envMapRotation!==void 0&&this.envMapRotation.fromArray(e.envMapRotation),e.envMapIntensity!==void 0&&(this.envMapIntensity=e.envMapIntensity),e.reflectivity!==void 0&&(this.reflectivity=e.reflectivity),e.refractionRatio!==void 0&&(this.refractionRatio=e.refractionRatio),e.lightMap!==void 0&&(this.lightMap=t[e.lightMap]||null),e.lightMapIntensity!==void 0&&(this.lightMapIntensity=e.lightMapIntensity),e.aoMap!==void 0&&(this.aoMap=t[e.aoMap]||null),e.aoMapIntensity!==void 0&&(this.aoMapIntensity=e.aoMapIntensity),e.gradientMap!==void 0&&(this.gradientMap=t[e.gradientMap]||null),e.clearcoatMap!==void 0&&(this.clearcoatMap=t[e.clearcoatMap]||null),e.clearcoatRoughnessMap!==void 0&&(this.clearcoatRoughnessMap=t[e.clearcoatRoughnessMap]||null),e.clearcoatNormalMap!==void 0&&(this.clearcoatNormalMap=t[e.clearcoatNormalMap]||null),e.clearcoatNormalScale!==void 0&&(this.clearcoatNormalScale=new qe().fromArray(e.clearcoatNormalScale)),e.diffuseRoughnessMap!==void 0&&(this.diffuseRoughnessMap=t[e.diffuseRoughnessMap]||null),e.iridescenceMap!==void 0&&(this.iridescenceMap=t[e.iridescenceMap]||null),e.iridescenceThicknessMap!==void 0&&(this.iridescenceThicknessMap=t[e.iridescenceThicknessMap]||null),e.transmissionMap!==void 0&&(this.transmissionMap=t[e.transmissionMap]||null),e.thicknessMap!==void 0&&(this.thicknessMap=t[e.thicknessMap]||null),e.anisotropyMap!==void 0&&(this.anisotropyMap=t[e.anisotropyMap]||null),e.sheenColorMap!==void 0&&(this.sheenColorMap=t[e.sheenColorMap]||null),e.sheenRoughnessMap!==void 0&&(this.sheenRoughnessMap=t[e.sheenRoughnessMap]||null),this}clone(){return new this.constructor().copy(this)}copy(e){this.name=e.name,this.blending=e.blending,this.side=e.side,this.vertexColors=e.vertexColors,this.opacity=e.opacity,this.transparent=e.transparent,this.blendSrc=e.blendSrc,this.blendDst=e.blendDst,this.blendEquation=e.blendEquation,this.blendSrcAlpha=e.blendSrcAlpha,this.blendDstAlpha=e.blendDstAlpha,this.blendEquationAlpha=e.blendEquationAlpha,this.blendColor.copy(e.blendColor),this.blendAlpha=e.blendAlpha,this.depthFunc=e.depthFunc,this.depthTest=e.depthTest,this.depthWrite=e.depthWrite,this.stencilWriteMask=e.stencilWriteMask,this.stencilFunc=e.stencilFunc,this.stencilRef=e.stencilRef,this.stencilFuncMask=e.stencilFuncMask,this.stencilFail=e.stencilFail,this.stencilZFail=e.stencilZFail,this.stencilZPass=e.stencilZPass,this.stencilWrite=e.stencilWrite;let t=e.clippingPlanes,n=null;if(t!==null){let s=t.length;n=new Array(s);for(let r=0;r!==s;++r)n[r]=t[r].clone()}return this.clippingPlanes=n,this.clipIntersection=e.clipIntersection,this.clipShadows=e.clipShadows,this.shadowSide=e.shadowSide,this.colorWrite=e.colorWrite,this.precision=e.precision,this.polygonOffset=e.polygonOffset,this.polygonOffsetFactor=e.polygonOffsetFactor,this.polygonOffsetUnits=e.polygonOffsetUnits,this.dithering=e.dithering,this.alphaTest=e.alphaTest,this.alphaHash=e.alphaHash,this.alphaToCoverage=e.alphaToCoverage,this.premultipliedAlpha=e.premultipliedAlpha,this.forceSinglePass=e.forceSinglePass,this.allowOverride=e.allowOverride,this.visible=e.visible,this.toneMapped=e.toneMapped,this.userData=JSON.parse(JSON.stringify(e.userData)),this}dispose(){this.dispatchEvent({type:"dispose"})}set needsUpdate(e){e===!0&&this.version++}};var Rs=new O,Tf=new O,Jl=new O,jl=new O,Qs=class{constructor(e=new O,t=new O(0,0,-1)){this.origin=e,this.direction=t}set(e,t){return this.origin.copy(e),this.direction.copy(t),this}copy(e){return this.origin.copy(e.origin),this.direction.copy(e.direction),this}at(e,t){return t.copy(this.origin).addScaledVector(this.direction,e)}lookAt(e){return this.direction.copy(e).sub(this.origin).normalize(),this}recast(e){return this.origin.copy(this.at(e,Rs)),this}closestPointToPoint(e,t){t.subVectors(e,this.origin);let n=t.dot(this.direction);return n<0?t.copy(this.origin):t.copy(this.origin).addScaledVector(this.direction,n)}distanceToPoint(e){return Math.sqrt(this.distanceSqToPoint(e))}distanceSqToPoint(e){let t=Rs.subVectors(e,this.origin).dot(this.direction);return t<0?this.origin.distanceToSquared(e):(Rs.copy(this.origin).addScaledVector(this.direction,t),Rs.distanceToSquared(e))}distanceSqToSegment(e,t,n,s){Tf.copy(e).add(t).multiplyScalar(.5),Jl.copy(t).sub(e).normalize(),jl.copy(this.origin).sub(Tf);let r=e.distanceTo(t)*.5,o=-this.direction.dot(Jl),a=jl.dot(this.direction),l=-jl.dot(Jl),c=jl.lengthSq(),h=Math.abs(1-o*o),u,f,p,g;if(h>0)if(u=o*l-a,f=o*a-l,g=r*h,u>=0)if(f>=-g)if(f<=g){let x=1/h;u*=x,f*=x,p=u*(u+o*f+2*a)+f*(o*u+f+2*l)+c}else f=r,u=Math.max(0,-(o*f+a)),p=-u*u+f*(f+2*l)+c;else f=-r,u=Math.max(0,-(o*f+a)),p=-u*u+f*(f+2*l)+c;else f<=-g?(u=Math.max(0,-(-o*r+a)),f=u>0?-r:Math.min(Math.max(-r,-l),r),p=-u*u+f*(f+2*l)+c):f<=g?(u=0,f=Math.min(Math.max(-r,-l),r),p=f*(f+2*l)+c):(u=Math.max(0,-(o*r+a)),f=u>0?r:Math.min(Math.max(-r,-l),r),p=-u*u+f*(f+2*l)+c);else f=o>0?-r:r,u=Math.max(0,-(o*f+a)),p=-u*u+f*(f+2*l)+c;return n&&n.copy(this.origin).addScaledVector(this.direction,u),s&&s.copy(Tf).addScaledVector(Jl,f),p}intersectSphere(e,t){if(e.radius<0)return null;Rs.subVectors(e.center,this.origin);let n=Rs.dot(this.direction),s=Rs.dot(Rs)-n*n,r=e.radius*e.radius;if(s>r)return null;let o=Math.sqrt(r-s),a=n-o,l=n+o;return l<0?null:a<0?this.at(l,t):this.at(a,t)}intersectsSphere(e){return e.radius<0?!1:this.distanceSqToPoint(e.center)<=e.radius*e.radius}distanceToPlane(e){let t=e.normal.dot(this.direction);if(t===0)return e.distanceToPoint(this.origin)===0?0:null;let n=-(this.origin.dot(e.normal)+e.constant)/t;return n>=0?n:null}intersectPlane(e,t){let n=this.distanceToPlane(e);return n===null?null:this.at(n,t)}intersectsPlane(e){let t=e.distanceToPoint(this.origin);return t===0||e.normal.dot(this.direction)*t<0}intersectBox(e,t){let n,s,r,o,a,l,c=1/this.direction.x,h=1/this.direction.y,u=1/this.direction.z,f=this.origin;return c>=0?(n=(e.min.x-f.x)*c,s=(e.max.x-f.x)*c):(n=(e.max.x-f.x)*c,s=(e.min.x-f.x)*c),h>=0?(r=(e.min.y-f.y)*h,o=(e.max.y-f.y)*h):(r=(e.max.y-f.y)*h,o=(e.min.y-f.y)*h),n>o||r>s||((r>n||isNaN(n))&&(n=r),(o<s||isNaN(s))&&(s=o),u>=0?(a=(e.min.z-f.z)*u,l=(e.max.z-f.z)*u):(a=(e.max.z-f.z)*u,l=(e.min.z-f.z)*u),n>l||a>s)||((a>n||n!==n)&&(n=a),(l<s||s!==s)&&(s=l),s<0)?null:this.at(n>=0?n:s,t)}intersectsBox(e){return this.intersectBox(e,Rs)!==null}intersectTriangle(e,t,n,s,r){let o=this.origin,a=this.direction,l=a.x,c=a.y,h=a.z,u=e.x-o.x,f=e.y-o.y,p=e.z-o.z,g=t.x-o.x,x=t.y-o.y,m=t.z-o.z,d=n.x-o.x,y=n.y-o.y,w=n.z-o.z,v=Math.abs(l),E=Math.abs(c),S=Math.abs(h),_,M,D,I,L,k,V,R,U,X,H,ae;if(v>=E&&v>=S?(D=l,k=u,U=g,ae=d,l>=0?(_=c,M=h,I=f,L=p,V=x,R=m,X=y,H=w):(_=h,M=c,I=p,L=f,V=m,R=x,X=w,H=y)):E>=S?(D=c,k=f,U=x,ae=y,c>=0?(_=h,M=l,I=p,L=u,V=m,R=g,X=w,H=d):(_=l,M=h,I=u,L=p,V=g,R=m,X=d,H=w)):(D=h,k=p,U=m,ae=w,h>=0?(_=l,M=c,I=u,L=f,V=g,R=x,X=d,H=y):(_=c,M=l,I=f,L=u,V=x,R=g,X=y,H=d)),D===0)return null;let Y=_/D,J=M/D,ee=1/D,fe=I-Y*k,ue=L-J*k,Q=V-Y*U,me=R-J*U,ge=X-Y*ae,_e=H-J*ae,ye=ge*me-_e*Q,He=fe*_e-ue*ge,Ke=Q*ue-me*fe;if(s){if(ye<0||He<0||Ke<0)return null}else if((ye<0||He<0||Ke<0)&&(ye>0||He>0||Ke>0))return null;let Oe=ye+He+Ke;if(Oe===0)return null;let it=ee*(ye*k+He*U+Ke*ae);return(Oe>0?it<0:it>0)?null:this.at(it/Oe,r)}applyMatrix4(e){return this.origin.applyMatrix4(e),this.direction.transformDirection(e),this}equals(e){return e.origin.equals(this.origin)&&e.direction.equals(this.direction)}clone(){return new this.constructor().copy(this)}},Ic=class extends Ns{constructor(e){super(),this.isMeshBasicMaterial=!0,this.type="MeshBasicMaterial",this.color=new dt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new Ds,this.combine=Jc,this.reflectivity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.lightMap=e.lightMap,this.lightMapIntensity=e.lightMapIntensity,this.aoMap=e.aoMap,this.aoMapIntensity=e.aoMapIntensity,this.specularMap=e.specularMap,this.alphaMap=e.alphaMap,this.envMap=e.envMap,this.envMapRotation.copy(e.envMapRotation),this.combine=e.combine,this.reflectivity=e.reflectivity,this.refractionRatio=e.refractionRatio,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.wireframeLinecap=e.wireframeLinecap,this.wireframeLinejoin=e.wireframeLinejoin,this.fog=e.fog,this}},Ag=new Vt,Tr=new Qs,Ql=new Rr,Eg=new O,ec=new O,tc=new O,nc=new O,Cf=new O,ic=new O,Tg=new O,sc=new O,_t=class extends Qn{constructor(e=new ct,t=new Ic){super(),this.isMesh=!0,this.type="Mesh",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.count=1,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}updateMorphTargets(){let t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){let s=t[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}getVertexPosition(e,t){let n=this.geometry,s=n.attributes.position,r=n.morphAttributes.position,o=n.morphTargetsRelative;t.fromBufferAttribute(s,e);let a=this.morphTargetInfluences;if(r&&a){ic.set(0,0,0);for(let l=0,c=r.length;l<c;l++){let h=a[l],u=r[l];h!==0&&(Cf.fromBufferAttribute(u,e),o?ic.addScaledVector(Cf,h):ic.addScaledVector(Cf.sub(t),h))}t.add(ic)}return t}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,s=this.material,r=this.matrixWorld;s!==void 0&&(n.boundingSphere===null&&n.computeBoundingSphere(),Ql.copy(n.boundingSphere),Ql.applyMatrix4(r),Tr.copy(e.ray).recast(e.near),!(Ql.containsPoint(Tr.origin)===!1&&(Tr.intersectSphere(Ql,Eg)===null||Tr.origin.distanceToSquared(Eg)>(e.far-e.near)**2))&&(Ag.copy(r).invert(),Tr.copy(e.ray).applyMatrix4(Ag),!(n.boundingBox!==null&&Tr.intersectsBox(n.boundingBox)===!1)&&this._computeIntersections(e,t,Tr)))}_computeIntersections(e,t,n){let s,r=this.geometry,o=this.material,a=r.index,l=r.attributes.position,c=r.attributes.uv,h=r.attributes.uv1,u=r.attributes.normal,f=r.groups,p=r.drawRange;if(a!==null)if(Array.isArray(o))for(let g=0,x=f.length;g<x;g++){let m=f[g],d=o[m.materialIndex],y=Math.max(m.start,p.start),w=Math.min(a.count,Math.min(m.start+m.count,p.start+p.count));for(let v=y,E=w;v<E;v+=3){let S=a.getX(v),_=a.getX(v+1),M=a.getX(v+2);s=rc(this,d,e,n,c,h,u,S,_,M),s&&(s.faceIndex=Math.floor(v/3),s.face.materialIndex=m.materialIndex,t.push(s))}}else{let g=Math.max(0,p.start),x=Math.min(a.count,p.start+p.count);for(let m=g,d=x;m<d;m+=3){let y=a.getX(m),w=a.getX(m+1),v=a.getX(m+2);s=rc(this,o,e,n,c,h,u,y,w,v),s&&(s.faceIndex=Math.floor(m/3),t.push(s))}}else if(l!==void 0)if(Array.isArray(o))for(let g=0,x=f.length;g<x;g++){let m=f[g],d=o[m.materialIndex],y=Math.max(m.start,p.start),w=Math.min(l.count,Math.min(m.start+m.count,p.start+p.count));for(let v=y,E=w;v<E;v+=3){let S=v,_=v+1,M=v+2;s=rc(this,d,e,n,c,h,u,S,_,M),s&&(s.faceIndex=Math.floor(v/3),s.face.materialIndex=m.materialIndex,t.push(s))}}else{let g=Math.max(0,p.start),x=Math.min(l.count,p.start+p.count);for(let m=g,d=x;m<d;m+=3){let y=m,w=m+1,v=m+2;s=rc(this,o,e,n,c,h,u,y,w,v),s&&(s.faceIndex=Math.floor(m/3),t.push(s))}}}};function Yb(i,e,t,n,s,r,o,a){let l;if(e.side===ui?l=n.intersectTriangle(o,r,s,!0,a):l=n.intersectTriangle(s,r,o,e.side===cr,a),l===null)return null;sc.copy(a),sc.applyMatrix4(i.matrixWorld);let c=t.ray.origin.distanceTo(sc);return c<t.near||c>t.far?null:{distance:c,point:sc.clone(),object:i}}function rc(i,e,t,n,s,r,o,a,l,c){i.getVertexPosition(a,ec),i.getVertexPosition(l,tc),i.getVertexPosition(c,nc);let h=Yb(i,e,t,n,ec,tc,nc,Tg);if(h){let u=new O;Is.getBarycoord(Tg,ec,tc,nc,u),s&&(h.uv=Is.getInterpolatedAttribute(s,a,l,c,u,new qe)),r&&(h.uv1=Is.getInterpolatedAttribute(r,a,l,c,u,new qe)),o&&(h.normal=Is.getInterpolatedAttribute(o,a,l,c,u,new O),h.normal.dot(n.direction)>0&&h.normal.multiplyScalar(-1));let f={a,b:l,c,normal:new O,materialIndex:0};Is.getNormal(ec,tc,nc,f.normal),h.face=f,h.barycoord=u}return h}var Pc=class extends fi{constructor(e=null,t=1,n=1,s,r,o,a,l,c=Bn,h=Bn,u,f){super(null,o,a,l,c,h,s,r,u,f),this.isDataTexture=!0,this.image={data:e,width:t,height:n},this.generateMipmaps=!1,this.flipY=!1,this.unpackAlignment=1}};var Cr=new Rr,Zb=new qe(.5,.5),oc=new O,er=class{constructor(e=new jn,t=new jn,n=new jn,s=new jn,r=new jn,o=new jn){this.planes=[e,t,n,s,r,o]}set(e,t,n,s,r,o){let a=this.planes;return a[0].copy(e),a[1].copy(t),a[2].copy(n),a[3].copy(s),a[4].copy(r),a[5].copy(o),this}copy(e){let t=this.planes;for(let n=0;n<6;n++)t[n].copy(e.planes[n]);return this}setFromProjectionMatrix(e,t=ki,n=!1){let s=this.planes,r=e.elements,o=r[0],a=r[1],l=r[2],c=r[3],h=r[4],u=r[5],f=r[6],p=r[7],g=r[8],x=r[9],m=r[10],d=r[11],y=r[12],w=r[13],v=r[14],E=r[15];if(s[0].setComponents(c-o,p-h,d-g,E-y).normalize(),s[1].setComponents(c+o,p+h,d+g,E+y).normalize(),s[2].setComponents(c+a,p+u,d+x,E+w).normalize(),s[3].setComponents(c-a,p-u,d-x,E-w).normalize(),n)s[4].setComponents(l,f,m,v).normalize(),s[5].setComponents(c-l,p-f,d-m,E-v).normalize();else if(s[4].setComponents(c-l,p-f,d-m,E-v).normalize(),t===ki)s[5].setComponents(c+l,p+f,d+m,E+v).normalize();else if(t===Lo)s[5].setComponents(l,f,m,v).normalize();else throw new Error("THREE.Frustum.setFromProjectionMatrix(): Invalid coordinate system: "+t);return this}intersectsObject(e){if(e.boundingSphere!==void 0)e.boundingSphere===null&&e.computeBoundingSphere(),Cr.copy(e.boundingSphere).applyMatrix4(e.matrixWorld);else{let t=e.geometry;t.boundingSphere===null&&t.computeBoundingSphere(),Cr.copy(t.boundingSphere).applyMatrix4(e.matrixWorld)}return this.intersectsSphere(Cr)}intersectsSprite(e){Cr.center.set(0,0,0);let t=Zb.distanceTo(e.center);return Cr.radius=.7071067811865476+t,Cr.applyMatrix4(e.matrixWorld),this.intersectsSphere(Cr)}intersectsSphere(e){let t=this.planes,n=e.center,s=-e.radius;for(let r=0;r<6;r++)if(t[r].distanceToPoint(n)<s)return!1;return!0}intersectsBox(e){let t=this.planes;for(let n=0;n<6;n++){let s=t[n];if(oc.x=s.normal.x>0?e.max.x:e.min.x,oc.y=s.normal.y>0?e.max.y:e.min.y,oc.z=s.normal.z>0?e.max.z:e.min.z,s.distanceToPoint(oc)<0)return!1}return!0}containsPoint(e){let t=this.planes;for(let n=0;n<6;n++)if(t[n].distanceToPoint(e)<0)return!1;return!0}clone(){return new this.constructor().copy(this)}},Cg=new Vt,Lc=class i{constructor(){this.coordinateSystem=ki,this._frustums=[],this._count=0}setFromArrayCamera(e){let t=e.cameras,n=this._frustums;for(let s=0;s<t.length;s++){let r=t[s];Cg.multiplyMatrices(r.projectionMatrix,r.matrixWorldInverse),n[s]===void 0&&(n[s]=new er),n[s].setFromProjectionMatrix(Cg,r.coordinateSystem,r.reversedDepth)}return this._count=t.length,this}getFrustum(e){return this._frustums[e]}intersectsObject(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsObject(e))return!0;return!1}intersectsSprite(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSprite(e))return!0;return!1}intersectsSphere(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsSphere(e))return!0;return!1}intersectsBox(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].intersectsBox(e))return!0;return!1}containsPoint(e){let t=this._frustums;for(let n=0;n<this._count;n++)if(t[n].containsPoint(e))return!0;return!1}copy(e){this.coordinateSystem=e.coordinateSystem;let t=this._frustums,n=e._frustums;for(let s=0;s<e._count;s++)t[s]===void 0&&(t[s]=new er),t[s].copy(n[s]);return this._count=e._count,this}clone(){return new i().copy(this)}};var zn=class extends Ns{constructor(e){super(),this.isLineBasicMaterial=!0,this.type="LineBasicMaterial",this.color=new dt(16777215),this.map=null,this.linewidth=1,this.linecap="round",this.linejoin="round",this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.linewidth=e.linewidth,this.linecap=e.linecap,this.linejoin=e.linejoin,this.fog=e.fog,this}},Dc=new O,Nc=new O,Rg=new Vt,Aa=new Qs,ac=new Rr,Rf=new O,Ig=new O,Ir=class extends Qn{constructor(e=new ct,t=new zn){super(),this.isLine=!0,this.type="Line",this.geometry=e,this.material=t,this.morphTargetDictionary=void 0,this.morphTargetInfluences=void 0,this.updateMorphTargets()}copy(e,t){return super.copy(e,t),e.morphTargetInfluences!==void 0?this.morphTargetInfluences=e.morphTargetInfluences.slice():this.morphTargetInfluences=void 0,e.morphTargetDictionary!==void 0?this.morphTargetDictionary=Object.assign({},e.morphTargetDictionary):this.morphTargetDictionary=void 0,this.material=Array.isArray(e.material)?e.material.slice():e.material,this.geometry=e.geometry,this}computeLineDistances(){let e=this.geometry;if(e.index===null){let t=e.attributes.position,n=[0];for(let s=1,r=t.count;s<r;s++)Dc.fromBufferAttribute(t,s-1),Nc.fromBufferAttribute(t,s),n[s]=n[s-1],n[s]+=Dc.distanceTo(Nc);e.setAttribute("lineDistance",new Nt(n,1))}else Ye("Line.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}intersectsFrustum(e){return e.intersectsObject(this)}raycast(e,t){let n=this.geometry,s=this.matrixWorld,r=e.params.Line.threshold,o=n.drawRange;if(n.boundingSphere===null&&n.computeBoundingSphere(),ac.copy(n.boundingSphere),ac.applyMatrix4(s),ac.radius+=r,e.ray.intersectsSphere(ac)===!1)return;Rg.copy(s).invert(),Aa.copy(e.ray).applyMatrix4(Rg);let a=r/((this.scale.x+this.scale.y+this.scale.z)/3),l=a*a,c=this.isLineSegments?2:1,h=n.index,f=n.attributes.position;if(h!==null){let p=Math.max(0,o.start),g=Math.min(h.count,o.start+o.count);for(let x=p,m=g-1;x<m;x+=c){let d=h.getX(x),y=h.getX(x+1),w=lc(this,e,Aa,l,d,y,x);w&&t.push(w)}if(this.isLineLoop){let x=h.getX(g-1),m=h.getX(p),d=lc(this,e,Aa,l,x,m,g-1);d&&t.push(d)}}else{let p=Math.max(0,o.start),g=Math.min(f.count,o.start+o.count);for(let x=p,m=g-1;x<m;x+=c){let d=lc(this,e,Aa,l,x,x+1,x);d&&t.push(d)}if(this.isLineLoop){let x=lc(this,e,Aa,l,g-1,p,g-1);x&&t.push(x)}}}updateMorphTargets(){let t=this.geometry.morphAttributes,n=Object.keys(t);if(n.length>0){let s=t[n[0]];if(s!==void 0){this.morphTargetInfluences=[],this.morphTargetDictionary={};for(let r=0,o=s.length;r<o;r++){let a=s[r].name||String(r);this.morphTargetInfluences.push(0),this.morphTargetDictionary[a]=r}}}}};function lc(i,e,t,n,s,r,o){let a=i.geometry.attributes.position;if(Dc.fromBufferAttribute(a,s),Nc.fromBufferAttribute(a,r),t.distanceSqToSegment(Dc,Nc,Rf,Ig)>n)return;Rf.applyMatrix4(i.matrixWorld);let c=e.ray.origin.distanceTo(Rf);if(!(c<e.near||c>e.far))return{distance:c,point:Ig.clone().applyMatrix4(i.matrixWorld),index:o,face:null,faceIndex:null,barycoord:null,object:i}}var Pg=new O,Lg=new O,Wn=class extends Ir{constructor(e,t){super(e,t),this.isLineSegments=!0,this.type="LineSegments"}computeLineDistances(){let e=this.geometry;if(e.index===null){let t=e.attributes.position,n=[];for(let s=0,r=t.count;s<r;s+=2)Pg.fromBufferAttribute(t,s),Lg.fromBufferAttribute(t,s+1),n[s]=s===0?0:n[s-1],n[s+1]=n[s]+Pg.distanceTo(Lg);e.setAttribute("lineDistance",new Nt(n,1))}else Ye("LineSegments.computeLineDistances(): Computation only possible with non-indexed BufferGeometry.");return this}};var Fa=class extends fi{constructor(e=[],t=Ur,n,s,r,o,a,l,c,h){super(e,t,n,s,r,o,a,l,c,h),this.isCubeTexture=!0,this.flipY=!1}get images(){return this.image}set images(e){this.image=e}};var Us=class extends fi{constructor(e,t,n=Ki,s,r,o,a=Bn,l=Bn,c,h=Ls,u=1){if(h!==Ls&&h!==Os)throw new Error("THREE.DepthTexture: format must be either THREE.DepthFormat or THREE.DepthStencilFormat");let f={width:e,height:t,depth:u};super(f,s,r,o,a,l,h,n,c),this.isDepthTexture=!0,this.flipY=!1,this.generateMipmaps=!1,this.compareFunction=null}copy(e){return super.copy(e),this.source=new Uo(Object.assign({},e.image)),this.compareFunction=e.compareFunction,this}toJSON(e){let t=super.toJSON(e);return t.compareFunction=this.compareFunction,t}},Oa=class extends Us{constructor(e,t=Ki,n=Ur,s,r,o=Bn,a=Bn,l,c=Ls){let h={width:e,height:e,depth:1},u=[h,h,h,h,h,h];super(e,e,t,n,s,r,o,a,l,c),this.image=u,this.isCubeDepthTexture=!0,this.isCubeTexture=!0}get images(){return this.image}set images(e){this.image=e}},ka=class extends fi{constructor(e=null){super(),this.sourceTexture=e,this.isExternalTexture=!0}copy(e){return super.copy(e),this.sourceTexture=e.sourceTexture,this}},tr=class i extends ct{constructor(e=1,t=1,n=1,s=1,r=1,o=1){super(),this.type="BoxGeometry",this.parameters={width:e,height:t,depth:n,widthSegments:s,heightSegments:r,depthSegments:o};let a=this;s=Math.floor(s),r=Math.floor(r),o=Math.floor(o);let l=[],c=[],h=[],u=[],f=0,p=0;g("z","y","x",-1,-1,n,t,e,o,r,0),g("z","y","x",1,-1,n,t,-e,o,r,1),g("x","z","y",1,1,e,n,t,s,o,2),g("x","z","y",1,-1,e,n,-t,s,o,3),g("x","y","z",1,-1,e,t,n,s,r,4),g("x","y","z",-1,-1,e,t,-n,s,r,5),this.setIndex(l),this.setAttribute("position",new Nt(c,3)),this.setAttribute("normal",new Nt(h,3)),this.setAttribute("uv",new Nt(u,2));function g(x,m,d,y,w,v,E,S,_,M,D){let I=v/_,L=E/M,k=v/2,V=E/2,R=S/2,U=_+1,X=M+1,H=0,ae=0,Y=new O;for(let J=0;J<X;J++){let ee=J*L-V;for(let fe=0;fe<U;fe++){let ue=fe*I-k;Y[x]=ue*y,Y[m]=ee*w,Y[d]=R,c.push(Y.x,Y.y,Y.z),Y[x]=0,Y[m]=0,Y[d]=S>0?1:-1,h.push(Y.x,Y.y,Y.z),u.push(fe/_),u.push(1-J/M),H+=1}}for(let J=0;J<M;J++)for(let ee=0;ee<_;ee++){let fe=f+ee+U*J,ue=f+ee+U*(J+1),Q=f+(ee+1)+U*(J+1),me=f+(ee+1)+U*J;l.push(fe,ue,me),l.push(ue,Q,me),ae+=6}a.addGroup(p,ae,D),p+=ae,f+=H}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.width,e.height,e.depth,e.widthSegments,e.heightSegments,e.depthSegments)}},Ba=class i extends ct{constructor(e=1,t=1,n=4,s=8,r=1){super(),this.type="CapsuleGeometry",this.parameters={radius:e,height:t,capSegments:n,radialSegments:s,heightSegments:r},t=Math.max(0,t),n=Math.max(1,Math.floor(n)),s=Math.max(3,Math.floor(s)),r=Math.max(1,Math.floor(r));let o=[],a=[],l=[],c=[],h=t/2,u=Math.PI/2*e,f=t,p=2*u+f,g=n*2+r,x=s+1,m=new O,d=new O;for(let y=0;y<=g;y++){let w=0,v=0,E=0,S=0;if(y<=n){let D=y/n,I=D*Math.PI/2;v=-h-e*Math.cos(I),E=e*Math.sin(I),S=-e*Math.cos(I),w=D*u}else if(y<=n+r){let D=(y-n)/r;v=-h+D*t,E=e,S=0,w=u+D*f}else{let D=(y-n-r)/n,I=D*Math.PI/2;v=h+e*Math.sin(I),E=e*Math.cos(I),S=e*Math.sin(I),w=u+f+D*u}let _=Math.max(0,Math.min(1,w/p)),M=0;y===0?M=.5/s:y===g&&(M=-.5/s);for(let D=0;D<=s;D++){let I=D/s,L=I*Math.PI*2,k=Math.sin(L),V=Math.cos(L);d.x=-E*V,d.y=v,d.z=E*k,a.push(d.x,d.y,d.z),m.set(-E*V,S,E*k),m.normalize(),l.push(m.x,m.y,m.z),c.push(I+M,_)}if(y>0){let D=(y-1)*x;for(let I=0;I<s;I++){let L=D+I,k=D+I+1,V=y*x+I,R=y*x+I+1;o.push(L,k,V),o.push(k,R,V)}}}this.setIndex(o),this.setAttribute("position",new Nt(a,3)),this.setAttribute("normal",new Nt(l,3)),this.setAttribute("uv",new Nt(c,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.radius,e.height,e.capSegments,e.radialSegments,e.heightSegments)}};var nr=class i extends ct{constructor(e=1,t=1,n=1,s=32,r=1,o=!1,a=0,l=Math.PI*2){super(),this.type="CylinderGeometry",this.parameters={radiusTop:e,radiusBottom:t,height:n,radialSegments:s,heightSegments:r,openEnded:o,thetaStart:a,thetaLength:l};let c=this;s=Math.floor(s),r=Math.floor(r);let h=[],u=[],f=[],p=[],g=0,x=[],m=n/2,d=0;y(),o===!1&&(e>0&&w(!0),t>0&&w(!1)),this.setIndex(h),this.setAttribute("position",new Nt(u,3)),this.setAttribute("normal",new Nt(f,3)),this.setAttribute("uv",new Nt(p,2));function y(){let v=new O,E=new O,S=0,_=(t-e)/n;for(let M=0;M<=r;M++){let D=[],I=M/r,L=I*(t-e)+e;for(let k=0;k<=s;k++){let V=k/s,R=V*l+a,U=Math.sin(R),X=Math.cos(R);E.x=L*U,E.y=-I*n+m,E.z=L*X,u.push(E.x,E.y,E.z),v.set(U,_,X).normalize(),f.push(v.x,v.y,v.z),p.push(V,1-I),D.push(g++)}x.push(D)}for(let M=0;M<s;M++)for(let D=0;D<r;D++){let I=x[D][M],L=x[D+1][M],k=x[D+1][M+1],V=x[D][M+1];(e>0||D!==0)&&(h.push(I,L,V),S+=3),(t>0||D!==r-1)&&(h.push(L,k,V),S+=3)}c.addGroup(d,S,0),d+=S}function w(v){let E=g,S=new qe,_=new O,M=0,D=v===!0?e:t,I=v===!0?1:-1;for(let k=1;k<=s;k++)u.push(0,m*I,0),f.push(0,I,0),p.push(.5,.5),g++;let L=g;for(let k=0;k<=s;k++){let R=k/s*l+a,U=Math.cos(R),X=Math.sin(R);_.x=D*X,_.y=m*I,_.z=D*U,u.push(_.x,_.y,_.z),f.push(0,I,0),S.x=U*.5+.5,S.y=X*.5*I+.5,p.push(S.x,S.y),g++}for(let k=0;k<s;k++){let V=E+k,R=L+k;v===!0?h.push(R,R+1,V):h.push(R+1,R,V),M+=3}c.addGroup(d,M,v===!0?1:2),d+=M}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.radiusTop,e.radiusBottom,e.height,e.radialSegments,e.heightSegments,e.openEnded,e.thetaStart,e.thetaLength)}},Pr=class i extends nr{constructor(e=1,t=1,n=32,s=1,r=!1,o=0,a=Math.PI*2){super(0,e,t,n,s,r,o,a),this.type="ConeGeometry",this.parameters={radius:e,height:t,radialSegments:n,heightSegments:s,openEnded:r,thetaStart:o,thetaLength:a}}static fromJSON(e){return new i(e.radius,e.height,e.radialSegments,e.heightSegments,e.openEnded,e.thetaStart,e.thetaLength)}},Uc=class i extends ct{constructor(e=[],t=[],n=1,s=0){super(),this.type="PolyhedronGeometry",this.parameters={vertices:e,indices:t,radius:n,detail:s};let r=[],o=[];a(s),c(n),h(),this.setAttribute("position",new Nt(r,3)),this.setAttribute("normal",new Nt(r.slice(),3)),this.setAttribute("uv",new Nt(o,2)),s===0?this.computeVertexNormals():this.normalizeNormals();function a(y){let w=new O,v=new O,E=new O;for(let S=0;S<t.length;S+=3)p(t[S+0],w),p(t[S+1],v),p(t[S+2],E),l(w,v,E,y)}function l(y,w,v,E){let S=E+1,_=[];for(let M=0;M<=S;M++){_[M]=[];let D=y.clone().lerp(v,M/S),I=w.clone().lerp(v,M/S),L=S-M;for(let k=0;k<=L;k++)k===0&&M===S?_[M][k]=D:_[M][k]=D.clone().lerp(I,k/L)}for(let M=0;M<S;M++)for(let D=0;D<2*(S-M)-1;D++){let I=Math.floor(D/2);D%2===0?(f(_[M][I+1]),f(_[M+1][I]),f(_[M][I])):(f(_[M][I+1]),f(_[M+1][I+1]),f(_[M+1][I]))}}function c(y){let w=new O;for(let v=0;v<r.length;v+=3)w.x=r[v+0],w.y=r[v+1],w.z=r[v+2],w.normalize().multiplyScalar(y),r[v+0]=w.x,r[v+1]=w.y,r[v+2]=w.z}function h(){let y=new O;for(let w=0;w<r.length;w+=3){y.x=r[w+0],y.y=r[w+1],y.z=r[w+2];let v=m(y)/2/Math.PI+.5,E=d(y)/Math.PI+.5;o.push(v,1-E)}g(),u()}function u(){for(let y=0;y<o.length;y+=6){let w=o[y+0],v=o[y+2],E=o[y+4],S=Math.max(w,v,E),_=Math.min(w,v,E);S>.9&&_<.1&&(w<.2&&(o[y+0]+=1),v<.2&&(o[y+2]+=1),E<.2&&(o[y+4]+=1))}}function f(y){r.push(y.x,y.y,y.z)}function p(y,w){let v=y*3;w.x=e[v+0],w.y=e[v+1],w.z=e[v+2]}function g(){let y=new O,w=new O,v=new O,E=new O,S=new qe,_=new qe,M=new qe;for(let D=0,I=0;D<r.length;D+=9,I+=6){y.set(r[D+0],r[D+1],r[D+2]),w.set(r[D+3],r[D+4],r[D+5]),v.set(r[D+6],r[D+7],r[D+8]),S.set(o[I+0],o[I+1]),_.set(o[I+2],o[I+3]),M.set(o[I+4],o[I+5]),E.copy(y).add(w).add(v).divideScalar(3);let L=m(E);x(S,I+0,y,L),x(_,I+2,w,L),x(M,I+4,v,L)}}function x(y,w,v,E){E<0&&y.x===1&&(o[w]=y.x-1),v.x===0&&v.z===0&&(o[w]=E/2/Math.PI+.5)}function m(y){return Math.atan2(y.z,-y.x)}function d(y){return Math.atan2(-y.y,Math.sqrt(y.x*y.x+y.z*y.z))}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.vertices,e.indices,e.radius,e.detail)}};var cc=new O,hc=new O,If=new O,uc=new Is,za=class extends ct{constructor(e=null,t=1){if(super(),this.type="EdgesGeometry",this.parameters={geometry:e,thresholdAngle:t},e!==null){let s=Math.pow(10,4),r=Math.cos(Ro*t),o=e.getIndex(),a=e.getAttribute("position"),l=o?o.count:a.count,c=[0,0,0],h=["a","b","c"],u=new Array(3),f=new Map,p=[];for(let g=0;g<l;g+=3){o?(c[0]=o.getX(g),c[1]=o.getX(g+1),c[2]=o.getX(g+2)):(c[0]=g,c[1]=g+1,c[2]=g+2);let{a:x,b:m,c:d}=uc;if(x.fromBufferAttribute(a,c[0]),m.fromBufferAttribute(a,c[1]),d.fromBufferAttribute(a,c[2]),uc.getNormal(If),u[0]=`${Math.round(x.x*s)},${Math.round(x.y*s)},${Math.round(x.z*s)}`,u[1]=`${Math.round(m.x*s)},${Math.round(m.y*s)},${Math.round(m.z*s)}`,u[2]=`${Math.round(d.x*s)},${Math.round(d.y*s)},${Math.round(d.z*s)}`,!(u[0]===u[1]||u[1]===u[2]||u[2]===u[0]))for(let y=0;y<3;y++){let w=(y+1)%3,v=u[y],E=u[w],S=uc[h[y]],_=uc[h[w]],M=`${v}_${E}`,D=`${E}_${v}`,I=f.get(D);I?(If.dot(I.normal)<=r&&(p.push(S.x,S.y,S.z),p.push(_.x,_.y,_.z)),f.set(D,null)):f.has(M)||f.set(M,{index0:c[y],index1:c[w],normal:If.clone()})}}for(let g of f.values())if(g){let{index0:x,index1:m}=g;cc.fromBufferAttribute(a,x),hc.fromBufferAttribute(a,m),p.push(cc.x,cc.y,cc.z),p.push(hc.x,hc.y,hc.z)}this.setAttribute("position",new Nt(p,3))}}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}};var Lr=class i extends Uc{constructor(e=1,t=0){let n=[1,0,0,-1,0,0,0,1,0,0,-1,0,0,0,1,0,0,-1],s=[0,2,4,0,4,3,0,3,5,0,5,2,1,2,5,1,5,3,1,3,4,1,4,2];super(n,s,e,t),this.type="OctahedronGeometry",this.parameters={radius:e,detail:t}}static fromJSON(e){return new i(e.radius,e.detail)}},Va=class i extends ct{constructor(e=1,t=1,n=1,s=1){super(),this.type="PlaneGeometry",this.parameters={width:e,height:t,widthSegments:n,heightSegments:s};let r=e/2,o=t/2,a=Math.floor(n),l=Math.floor(s),c=a+1,h=l+1,u=e/a,f=t/l,p=[],g=[],x=[],m=[];for(let d=0;d<h;d++){let y=d*f-o;for(let w=0;w<c;w++){let v=w*u-r;g.push(v,-y,0),x.push(0,0,1),m.push(w/a),m.push(1-d/l)}}for(let d=0;d<l;d++)for(let y=0;y<a;y++){let w=y+c*d,v=y+c*(d+1),E=y+1+c*(d+1),S=y+1+c*d;p.push(w,v,S),p.push(v,E,S)}this.setIndex(p),this.setAttribute("position",new Nt(g,3)),this.setAttribute("normal",new Nt(x,3)),this.setAttribute("uv",new Nt(m,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.width,e.height,e.widthSegments,e.heightSegments)}};var Ri=class i extends ct{constructor(e=1,t=32,n=16,s=0,r=Math.PI*2,o=0,a=Math.PI){super(),this.type="SphereGeometry",this.parameters={radius:e,widthSegments:t,heightSegments:n,phiStart:s,phiLength:r,thetaStart:o,thetaLength:a},t=Math.max(3,Math.floor(t)),n=Math.max(2,Math.floor(n));let l=Math.min(o+a,Math.PI),c=0,h=[],u=new O,f=new O,p=[],g=[],x=[],m=[];for(let d=0;d<=n;d++){let y=[],w=d/n,v=o+w*a,E=e*Math.cos(v),S=Math.sqrt(e*e-E*E),_=0;d===0&&o===0?_=.5/t:d===n&&l===Math.PI&&(_=-.5/t);for(let M=0;M<=t;M++){let D=M/t,I=s+D*r;u.x=-S*Math.cos(I),u.y=E,u.z=S*Math.sin(I),g.push(u.x,u.y,u.z),f.copy(u).normalize(),x.push(f.x,f.y,f.z),m.push(D+_,1-w),y.push(c++)}h.push(y)}for(let d=0;d<n;d++)for(let y=0;y<t;y++){let w=h[d][y+1],v=h[d][y],E=h[d+1][y],S=h[d+1][y+1];(d!==0||o>0)&&p.push(w,v,S),(d!==n-1||l<Math.PI)&&p.push(v,E,S)}this.setIndex(p),this.setAttribute("position",new Nt(g,3)),this.setAttribute("normal",new Nt(x,3)),this.setAttribute("uv",new Nt(m,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.radius,e.widthSegments,e.heightSegments,e.phiStart,e.phiLength,e.thetaStart,e.thetaLength)}};var ir=class i extends ct{constructor(e=1,t=.4,n=12,s=48,r=Math.PI*2,o=0,a=Math.PI*2){super(),this.type="TorusGeometry",this.parameters={radius:e,tube:t,radialSegments:n,tubularSegments:s,arc:r,thetaStart:o,thetaLength:a},n=Math.floor(n),s=Math.floor(s);let l=[],c=[],h=[],u=[],f=new O,p=new O,g=new O;for(let x=0;x<=n;x++){let m=o+x/n*a;for(let d=0;d<=s;d++){let y=d/s*r;p.x=(e+t*Math.cos(m))*Math.cos(y),p.y=(e+t*Math.cos(m))*Math.sin(y),p.z=t*Math.sin(m),c.push(p.x,p.y,p.z),f.x=e*Math.cos(y),f.y=e*Math.sin(y),g.subVectors(p,f).normalize(),h.push(g.x,g.y,g.z),u.push(d/s),u.push(x/n)}}for(let x=1;x<=n;x++)for(let m=1;m<=s;m++){let d=(s+1)*x+m-1,y=(s+1)*(x-1)+m-1,w=(s+1)*(x-1)+m,v=(s+1)*x+m;l.push(d,y,v),l.push(y,w,v)}this.setIndex(l),this.setAttribute("position",new Nt(c,3)),this.setAttribute("normal",new Nt(h,3)),this.setAttribute("uv",new Nt(u,2))}copy(e){return super.copy(e),this.parameters=Object.assign({},e.parameters),this}static fromJSON(e){return new i(e.radius,e.tube,e.radialSegments,e.tubularSegments,e.arc,e.thetaStart,e.thetaLength)}};function Or(i){let e={};for(let t in i){e[t]={};for(let n in i[t]){let s=i[t][n];if(Dg(s))s.isRenderTargetTexture?(Ye("UniformsUtils: Textures of render targets cannot be cloned via cloneUniforms() or mergeUniforms()."),e[t][n]=null):e[t][n]=s.clone();else if(Array.isArray(s))if(Dg(s[0])){let r=[];for(let o=0,a=s.length;o<a;o++)r[o]=s[o].clone();e[t][n]=r}else e[t][n]=s.slice();else e[t][n]=s}}return e}function ei(i){let e={};for(let t=0;t<i.length;t++){let n=Or(i[t]);for(let s in n)e[s]=n[s]}return e}function Dg(i){return i&&(i.isColor||i.isMatrix3||i.isMatrix4||i.isVector2||i.isVector3||i.isVector4||i.isTexture||i.isQuaternion)}function Kb(i){let e=[];for(let t=0;t<i.length;t++)e.push(i[t].clone());return e}function gd(i){let e=i.getRenderTarget();return e===null?i.outputColorSpace:e.isXRRenderTarget===!0?e.texture.colorSpace:bt.workingColorSpace}var C0={clone:Or,merge:ei},Jb=`void main() {
	gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
}`,jb=`void main() {
	gl_FragColor = vec4( 1.0, 0.0, 0.0, 1.0 );
}`,ps=class extends Ns{constructor(e){super(),this.isShaderMaterial=!0,this.type="ShaderMaterial",this.defines={},this.uniforms={},this.uniformsGroups=[],this.vertexShader=Jb,this.fragmentShader=jb,this.linewidth=1,this.wireframe=!1,this.wireframeLinewidth=1,this.fog=!1,this.lights=!1,this.clipping=!1,this.forceSinglePass=!0,this.extensions={clipCullDistance:!1,multiDraw:!1},this.defaultAttributeValues={color:[1,1,1],uv:[0,0],uv1:[0,0]},this.index0AttributeName=void 0,this.uniformsNeedUpdate=!1,this.glslVersion=null,e!==void 0&&this.setValues(e)}copy(e){return super.copy(e),this.fragmentShader=e.fragmentShader,this.vertexShader=e.vertexShader,this.uniforms=Or(e.uniforms),this.uniformsGroups=Kb(e.uniformsGroups),this.defines=Object.assign({},e.defines),this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.fog=e.fog,this.lights=e.lights,this.clipping=e.clipping,this.extensions=Object.assign({},e.extensions),this.glslVersion=e.glslVersion,this.defaultAttributeValues=Object.assign({},e.defaultAttributeValues),this.index0AttributeName=e.index0AttributeName,this.uniformsNeedUpdate=e.uniformsNeedUpdate,this}toJSON(e){let t=super.toJSON(e);t.glslVersion=this.glslVersion,t.uniforms={};for(let s in this.uniforms){let o=this.uniforms[s].value;o&&o.isTexture?t.uniforms[s]={type:"t",value:o.toJSON(e).uuid}:o&&o.isColor?t.uniforms[s]={type:"c",value:o.getHex()}:o&&o.isVector2?t.uniforms[s]={type:"v2",value:o.toArray()}:o&&o.isVector3?t.uniforms[s]={type:"v3",value:o.toArray()}:o&&o.isVector4?t.uniforms[s]={type:"v4",value:o.toArray()}:o&&o.isMatrix3?t.uniforms[s]={type:"m3",value:o.toArray()}:o&&o.isMatrix4?t.uniforms[s]={type:"m4",value:o.toArray()}:t.uniforms[s]={value:o}}Object.keys(this.defines).length>0&&(t.defines=this.defines),t.vertexShader=this.vertexShader,t.fragmentShader=this.fragmentShader,t.lights=this.lights,t.clipping=this.clipping;let n={};for(let s in this.extensions)this.extensions[s]===!0&&(n[s]=!0);return Object.keys(n).length>0&&(t.extensions=n),t}fromJSON(e,t){if(super.fromJSON(e,t),e.uniforms!==void 0)for(let n in e.uniforms){let s=e.uniforms[n];switch(this.uniforms[n]={},s.type){case"t":this.uniforms[n].value=t[s.value]||null;break;case"c":this.uniforms[n].value=new dt().setHex(s.value);break;case"v2":this.uniforms[n].value=new qe().fromArray(s.value);break;case"v3":this.uniforms[n].value=new O().fromArray(s.value);break;case"v4":this.uniforms[n].value=new nn().fromArray(s.value);break;case"m3":this.uniforms[n].value=new nt().fromArray(s.value);break;case"m4":this.uniforms[n].value=new Vt().fromArray(s.value);break;default:this.uniforms[n].value=s.value}}if(e.defines!==void 0&&(this.defines=e.defines),e.vertexShader!==void 0&&(this.vertexShader=e.vertexShader),e.fragmentShader!==void 0&&(this.fragmentShader=e.fragmentShader),e.glslVersion!==void 0&&(this.glslVersion=e.glslVersion),e.extensions!==void 0)for(let n in e.extensions)this.extensions[n]=e.extensions[n];return e.lights!==void 0&&(this.lights=e.lights),e.clipping!==void 0&&(this.clipping=e.clipping),this}},Fc=class extends ps{constructor(e){super(e),this.isRawShaderMaterial=!0,this.type="RawShaderMaterial"}};var Xn=class extends Ns{constructor(e){super(),this.isMeshLambertMaterial=!0,this.type="MeshLambertMaterial",this.color=new dt(16777215),this.map=null,this.lightMap=null,this.lightMapIntensity=1,this.aoMap=null,this.aoMapIntensity=1,this.emissive=new dt(0),this.emissiveIntensity=1,this.emissiveMap=null,this.bumpMap=null,this.bumpScale=1,this.normalMap=null,this.normalMapType=Oh,this.normalScale=new qe(1,1),this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.specularMap=null,this.alphaMap=null,this.envMap=null,this.envMapRotation=new Ds,this.combine=Jc,this.reflectivity=1,this.envMapIntensity=1,this.refractionRatio=.98,this.wireframe=!1,this.wireframeLinewidth=1,this.wireframeLinecap="round",this.wireframeLinejoin="round",this.flatShading=!1,this.fog=!0,this.setValues(e)}copy(e){return super.copy(e),this.color.copy(e.color),this.map=e.map,this.lightMap=e.lightMap,this.lightMapIntensity=e.lightMapIntensity,this.aoMap=e.aoMap,this.aoMapIntensity=e.aoMapIntensity,this.emissive.copy(e.emissive),this.emissiveMap=e.emissiveMap,this.emissiveIntensity=e.emissiveIntensity,this.bumpMap=e.bumpMap,this.bumpScale=e.bumpScale,this.normalMap=e.normalMap,this.normalMapType=e.normalMapType,this.normalScale.copy(e.normalScale),this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this.specularMap=e.specularMap,this.alphaMap=e.alphaMap,this.envMap=e.envMap,this.envMapRotation.copy(e.envMapRotation),this.combine=e.combine,this.reflectivity=e.reflectivity,this.envMapIntensity=e.envMapIntensity,this.refractionRatio=e.refractionRatio,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this.wireframeLinecap=e.wireframeLinecap,this.wireframeLinejoin=e.wireframeLinejoin,this.flatShading=e.flatShading,this.fog=e.fog,this}},Oc=class extends Ns{constructor(e){super(),this.isMeshDepthMaterial=!0,this.type="MeshDepthMaterial",this.depthPacking=f0,this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.wireframe=!1,this.wireframeLinewidth=1,this.setValues(e)}copy(e){return super.copy(e),this.depthPacking=e.depthPacking,this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this.wireframe=e.wireframe,this.wireframeLinewidth=e.wireframeLinewidth,this}},kc=class extends Ns{constructor(e){super(),this.isMeshDistanceMaterial=!0,this.type="MeshDistanceMaterial",this.map=null,this.alphaMap=null,this.displacementMap=null,this.displacementScale=1,this.displacementBias=0,this.setValues(e)}copy(e){return super.copy(e),this.map=e.map,this.alphaMap=e.alphaMap,this.displacementMap=e.displacementMap,this.displacementScale=e.displacementScale,this.displacementBias=e.displacementBias,this}};function Eo(i,e){return!i||i.constructor===e?i:typeof e.BYTES_PER_ELEMENT=="number"?new e(i):Array.prototype.slice.call(i)}function fc(i){return i!==void 0&&i.inTangents!==void 0&&i.outTangents!==void 0}var sr=class{constructor(e,t,n,s){this.parameterPositions=e,this._cachedIndex=0,this.resultBuffer=s!==void 0?s:new t.constructor(n),this.sampleValues=t,this.valueSize=n,this.settings=null,this.DefaultSettings_={}}evaluate(e){let t=this.parameterPositions,n=this._cachedIndex,s=t[n],r=t[n-1];n:{e:{let o;t:{i:if(!(e<s)){for(let a=n+2;;){if(s===void 0){if(e<r)break i;return n=t.length,this._cachedIndex=n,this.copySampleValue_(n-1)}if(n===a)break;if(r=s,s=t[++n],e<s)break e}o=t.length;break t}if(!(e>=r)){let a=t[1];e<a&&(n=2,r=a);for(let l=n-2;;){if(r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(n===l)break;if(s=r,r=t[--n-1],e>=r)break e}o=n,n=0;break t}break n}for(;n<o;){let a=n+o>>>1;e<t[a]?o=a:n=a+1}if(s=t[n],r=t[n-1],r===void 0)return this._cachedIndex=0,this.copySampleValue_(0);if(s===void 0)return n=t.length,this._cachedIndex=n,this.copySampleValue_(n-1)}this._cachedIndex=n,this.intervalChanged_(n,r,s)}return this.interpolate_(n,r,e,s)}getSettings_(){return this.settings||this.DefaultSettings_}copySampleValue_(e){let t=this.resultBuffer,n=this.sampleValues,s=this.valueSize,r=e*s;for(let o=0;o!==s;++o)t[o]=n[r+o];return t}interpolate_(){throw new Error("THREE.Interpolant: Call to abstract method.")}intervalChanged_(){}},Bc=class extends sr{constructor(e,t,n,s){super(e,t,n,s),this._weightPrev=-0,this._offsetPrev=-0,this._weightNext=-0,this._offsetNext=-0,this.DefaultSettings_={endingStart:Df,endingEnd:Df}}intervalChanged_(e,t,n){let s=this.parameterPositions,r=e-2,o=e+1,a=s[r],l=s[o];if(a===void 0)switch(this.getSettings_().endingStart){case Nf:r=e,a=2*t-n;break;case Uf:r=s.length-2,a=t+s[r]-s[r+1];break;default:r=e,a=n}if(l===void 0)switch(this.getSettings_().endingEnd){case Nf:o=e,l=2*n-t;break;case Uf:o=1,l=n+s[1]-s[0];break;default:o=e-1,l=t}let c=(n-t)*.5,h=this.valueSize;this._weightPrev=c/(t-a),this._weightNext=c/(l-n),this._offsetPrev=r*h,this._offsetNext=o*h}interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=this._offsetPrev,u=this._offsetNext,f=this._weightPrev,p=this._weightNext,g=(n-t)/(s-t),x=g*g,m=x*g,d=-f*m+2*f*x-f*g,y=(1+f)*m+(-1.5-2*f)*x+(-.5+f)*g+1,w=(-1-p)*m+(1.5+p)*x+.5*g,v=p*m-p*x;for(let E=0;E!==a;++E)r[E]=d*o[h+E]+y*o[c+E]+w*o[l+E]+v*o[u+E];return r}},zc=class extends sr{constructor(e,t,n,s){super(e,t,n,s)}interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=(n-t)/(s-t),u=1-h;for(let f=0;f!==a;++f)r[f]=o[c+f]*u+o[l+f]*h;return r}},Vc=class extends sr{constructor(e,t,n,s){super(e,t,n,s)}interpolate_(e){return this.copySampleValue_(e-1)}},Hc=class extends sr{interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=e*a,c=l-a,h=this.inTangents,u=this.outTangents;if(!h||!u){let g=(n-t)/(s-t),x=1-g;for(let m=0;m!==a;++m)r[m]=o[c+m]*x+o[l+m]*g;return r}let f=a*2,p=e-1;for(let g=0;g!==a;++g){let x=o[c+g],m=o[l+g],d=p*f+g*2,y=u[d],w=u[d+1],v=e*f+g*2,E=h[v],S=h[v+1],_=eM(n,t,y,E,s);r[g]=R0(_,x,w,S,m)}return r}};function R0(i,e,t,n,s){let r=1-i;return r*r*r*e+3*r*r*i*t+3*r*i*i*n+i*i*i*s}function Qb(i,e,t,n,s){let r=1-i;return 3*r*r*(t-e)+6*r*i*(n-t)+3*i*i*(s-n)}function eM(i,e,t,n,s){let r=(i-e)/(s-e);for(let o=0;o<8;o++){let a=R0(r,e,t,n,s)-i;if(Math.abs(a)<1e-10)break;let l=Qb(r,e,t,n,s);if(Math.abs(l)<1e-10)break;r=Math.max(0,Math.min(1,r-a/l))}return r}var Ii=class{constructor(e,t,n,s){if(e===void 0)throw new Error("THREE.KeyframeTrack: track name is undefined");if(t===void 0||t.length===0)throw new Error("THREE.KeyframeTrack: no keyframes in track named "+e);this.name=e,this.times=Eo(t,this.TimeBufferType),this.values=Eo(n,this.ValueBufferType),this.setInterpolation(s||this.DefaultInterpolation)}static toJSON(e){let t=e.constructor,n;if(t.toJSON!==this.toJSON)n=t.toJSON(e);else{n={name:e.name,times:Eo(e.times,Array),values:Eo(e.values,Array)};let s=e.getInterpolation();s!==e.DefaultInterpolation&&(n.interpolation=s),fc(e.settings)&&(n.settings={inTangents:Eo(e.settings.inTangents,Array),outTangents:Eo(e.settings.outTangents,Array)})}return n.type=e.ValueTypeName,n}InterpolantFactoryMethodDiscrete(e){return new Vc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodLinear(e){return new zc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodSmooth(e){return new Bc(this.times,this.values,this.getValueSize(),e)}InterpolantFactoryMethodBezier(e){let t=new Hc(this.times,this.values,this.getValueSize(),e);return this.settings&&(t.inTangents=this.settings.inTangents,t.outTangents=this.settings.outTangents),t}setInterpolation(e){let t;switch(e){case Ca:t=this.InterpolantFactoryMethodDiscrete;break;case Ec:t=this.InterpolantFactoryMethodLinear;break;case mc:t=this.InterpolantFactoryMethodSmooth;break;case Lf:t=this.InterpolantFactoryMethodBezier;break}if(t===void 0){let n="unsupported interpolation for "+this.ValueTypeName+" keyframe track named "+this.name;if(this.createInterpolant===void 0)if(e!==this.DefaultInterpolation)this.setInterpolation(this.DefaultInterpolation);else throw new Error(n);return Ye("KeyframeTrack:",n),this}return this.createInterpolant=t,this}getInterpolation(){switch(this.createInterpolant){case this.InterpolantFactoryMethodDiscrete:return Ca;case this.InterpolantFactoryMethodLinear:return Ec;case this.InterpolantFactoryMethodSmooth:return mc;case this.InterpolantFactoryMethodBezier:return Lf}}getValueSize(){return this.values.length/this.times.length}shift(e){if(e!==0){let t=this.times;for(let n=0,s=t.length;n!==s;++n)t[n]+=e;fc(this.settings)&&(Ng(this.settings.inTangents,e),Ng(this.settings.outTangents,e))}return this}scale(e){if(e!==1){let t=this.times;for(let n=0,s=t.length;n!==s;++n)t[n]*=e;fc(this.settings)&&(Ug(this.settings.inTangents,e),Ug(this.settings.outTangents,e))}return this}trim(e,t){let n=this.times,s=n.length,r=0,o=s-1;for(;r!==s&&n[r]<e;)++r;for(;o!==-1&&n[o]>t;)--o;if(++o,r!==0||o!==s){r>=o&&(o=Math.max(o,1),r=o-1);let a=this.getValueSize();this.times=n.slice(r,o),this.values=this.values.slice(r*a,o*a)}return this}validate(){let e=!0,t=this.getValueSize();t-Math.floor(t)!==0&&(et("KeyframeTrack: Invalid value size in track.",this),e=!1);let n=this.times,s=this.values,r=n.length;r===0&&(et("KeyframeTrack: Track is empty.",this),e=!1);let o=null;for(let a=0;a!==r;a++){let l=n[a];if(typeof l=="number"&&isNaN(l)){et("KeyframeTrack: Time is not a valid number.",this,a,l),e=!1;break}if(o!==null&&o>l){et("KeyframeTrack: Out of order keys.",this,a,l,o),e=!1;break}o=l}if(s!==void 0&&gb(s))for(let a=0,l=s.length;a!==l;++a){let c=s[a];if(isNaN(c)){et("KeyframeTrack: Value is not a valid number.",this,a,c),e=!1;break}}return e}optimize(){let e=this.times.slice(),t=this.values.slice(),n=this.getValueSize(),s=this.getInterpolation()===mc,r=e.length-1,o=1;for(let a=1;a<r;++a){let l=!1,c=e[a],h=e[a+1];if(c!==h&&(a!==1||c!==e[0]))if(s)l=!0;else{let u=a*n,f=u-n,p=u+n;for(let g=0;g!==n;++g){let x=t[u+g];if(x!==t[f+g]||x!==t[p+g]){l=!0;break}}}if(l){if(a!==o){e[o]=e[a];let u=a*n,f=o*n;for(let p=0;p!==n;++p)t[f+p]=t[u+p]}++o}}if(r>0){e[o]=e[r];for(let a=r*n,l=o*n,c=0;c!==n;++c)t[l+c]=t[a+c];++o}return o!==e.length?(this.times=e.slice(0,o),this.values=t.slice(0,o*n)):(this.times=e,this.values=t),this}clone(){let e=this.times.slice(),t=this.values.slice(),n=this.constructor,s=new n(this.name,e,t);return s.createInterpolant=this.createInterpolant,fc(this.settings)&&(s.settings={inTangents:this.settings.inTangents.slice(),outTangents:this.settings.outTangents.slice()}),s}};function Ng(i,e){for(let t=0,n=i.length;t!==n;t+=2)i[t]+=e}function Ug(i,e){for(let t=0,n=i.length;t!==n;t+=2)i[t]*=e}Ii.prototype.ValueTypeName="";Ii.prototype.TimeBufferType=Float32Array;Ii.prototype.ValueBufferType=Float32Array;Ii.prototype.DefaultInterpolation=Ec;var rr=class extends Ii{constructor(e,t,n){super(e,t,n)}};rr.prototype.ValueTypeName="bool";rr.prototype.ValueBufferType=Array;rr.prototype.DefaultInterpolation=Ca;rr.prototype.InterpolantFactoryMethodLinear=void 0;rr.prototype.InterpolantFactoryMethodSmooth=void 0;var Gc=class extends Ii{constructor(e,t,n,s){super(e,t,n,s)}};Gc.prototype.ValueTypeName="color";var Wc=class extends Ii{constructor(e,t,n,s){super(e,t,n,s)}};Wc.prototype.ValueTypeName="number";var Xc=class extends sr{constructor(e,t,n,s){super(e,t,n,s)}interpolate_(e,t,n,s){let r=this.resultBuffer,o=this.sampleValues,a=this.valueSize,l=(n-t)/(s-t),c=e*a;for(let h=c+a;c!==h;c+=4)tn.slerpFlat(r,0,o,c-a,o,c,l);return r}},Ha=class extends Ii{constructor(e,t,n,s){super(e,t,n,s)}InterpolantFactoryMethodLinear(e){return new Xc(this.times,this.values,this.getValueSize(),e)}};Ha.prototype.ValueTypeName="quaternion";Ha.prototype.InterpolantFactoryMethodSmooth=void 0;var or=class extends Ii{constructor(e,t,n){super(e,t,n)}};or.prototype.ValueTypeName="string";or.prototype.ValueBufferType=Array;or.prototype.DefaultInterpolation=Ca;or.prototype.InterpolantFactoryMethodLinear=void 0;or.prototype.InterpolantFactoryMethodSmooth=void 0;var $c=class extends Ii{constructor(e,t,n,s){super(e,t,n,s)}};$c.prototype.ValueTypeName="vector";var qc=class{constructor(e,t,n){let s=this,r=!1,o=0,a=0,l,c=[];this.onStart=void 0,this.onLoad=e,this.onProgress=t,this.onError=n,this._abortController=null,this.itemStart=function(h){a++,r===!1&&s.onStart!==void 0&&s.onStart(h,o,a),r=!0},this.itemEnd=function(h){o++,s.onProgress!==void 0&&s.onProgress(h,o,a),o===a&&(r=!1,s.onLoad!==void 0&&s.onLoad())},this.itemError=function(h){s.onError!==void 0&&s.onError(h)},this.resolveURL=function(h){return h=h.normalize("NFC"),l?l(h):h},this.setURLModifier=function(h){return l=h,this},this.addHandler=function(h,u){return c.push(h,u),this},this.removeHandler=function(h){let u=c.indexOf(h);return u!==-1&&c.splice(u,2),this},this.getHandler=function(h){for(let u=0,f=c.length;u<f;u+=2){let p=c[u],g=c[u+1];if(p.global&&(p.lastIndex=0),p.test(h))return g}return null},this.abort=function(){return this.abortController.abort(),this._abortController=null,this}}get abortController(){return this._abortController||(this._abortController=new AbortController),this._abortController}},I0=new qc,Yc=class{constructor(e){this.manager=e!==void 0?e:I0,this.crossOrigin="anonymous",this.withCredentials=!1,this.path="",this.resourcePath="",this.requestHeader={},this.priority="auto",this.cache="default",typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}load(){}loadAsync(e,t){let n=this;return new Promise(function(s,r){n.load(e,s,t,r)})}parse(){}setCrossOrigin(e){return this.crossOrigin=e,this}setWithCredentials(e){return this.withCredentials=e,this}setPath(e){return this.path=e,this}setResourcePath(e){return this.resourcePath=e,this}setRequestHeader(e){return this.requestHeader=e,this}setPriority(e){return this.priority=e,this}setCache(e){return this.cache=e,this}abort(){return this}};Yc.DEFAULT_MATERIAL_NAME="__DEFAULT";var Ga=class extends Qn{static registerNode(e){this.prototype._lightNode=e}constructor(e,t=1){super(),this.isLight=!0,this.type="Light",this.color=new dt(e),this.intensity=t}copy(e,t){return super.copy(e,t),this.color.copy(e.color),this.intensity=e.intensity,this}toJSON(e){let t=super.toJSON(e);return t.object.color=this.color.getHex(),t.object.intensity=this.intensity,t}};var Pf=new Vt,Fg=new O,Og=new O,Zc=class{constructor(e){this.camera=e,this.intensity=1,this.bias=0,this.biasNode=null,this.normalBias=0,this.radius=1,this.blurSamples=8,this.mapSize=new qe(512,512),this.mapType=pi,this.map=null,this.mapPass=null,this.matrix=new Vt,this.autoUpdate=!0,this.needsUpdate=!1,this._frustum=new er,this._frameExtents=new qe(1,1),this._viewportCount=1,this._viewports=[new nn(0,0,1,1)]}getViewportCount(){return this._viewportCount}getCamera(){return this.camera}getFrustum(){return this._frustum}updateMatrices(e){let t=this.camera;Fg.setFromMatrixPosition(e.matrixWorld),t.position.copy(Fg),Og.setFromMatrixPosition(e.target.matrixWorld),t.lookAt(Og),t.updateMatrixWorld(),this._updateMatrix(t,this.matrix,this._frustum)}_updateMatrix(e,t,n,s){Pf.multiplyMatrices(e.projectionMatrix,e.matrixWorldInverse),n.setFromProjectionMatrix(Pf,e.coordinateSystem,e.reversedDepth);let r=this._frameExtents,o=s?s.z/r.x:1,a=s?s.w/r.y:1,l=s?s.x/r.x:0,c=s?s.y/r.y:0;e.coordinateSystem===Lo||e.reversedDepth?t.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,1,0,0,0,0,1):t.set(.5*o,0,0,.5*o+l,0,.5*a,0,.5*a+c,0,0,.5,.5,0,0,0,1),t.multiply(Pf)}getViewport(e){return this._viewports[e]}getFrameExtents(){return this._frameExtents}dispose(){this.map&&this.map.dispose(),this.mapPass&&this.mapPass.dispose()}copy(e){return this.camera=e.camera.clone(),this.intensity=e.intensity,this.bias=e.bias,this.radius=e.radius,this.autoUpdate=e.autoUpdate,this.needsUpdate=e.needsUpdate,this.normalBias=e.normalBias,this.blurSamples=e.blurSamples,this.mapSize.copy(e.mapSize),this.mapType=e.mapType,this.biasNode=e.biasNode,this}clone(){return new this.constructor().copy(this)}toJSON(){let e={};return e.intensity=this.intensity,e.bias=this.bias,e.normalBias=this.normalBias,e.radius=this.radius,e.blurSamples=this.blurSamples,e.mapSize=this.mapSize.toArray(),e.mapType=this.mapType,e.camera=this.camera.toJSON(!1).object,delete e.camera.matrix,e}},dc=new O,pc=new tn,us=new O,Wa=class extends Qn{constructor(){super(),this.isCamera=!0,this.type="Camera",this.matrixWorldInverse=new Vt,this.projectionMatrix=new Vt,this.projectionMatrixInverse=new Vt,this.coordinateSystem=ki,this._reversedDepth=!1}get reversedDepth(){return this._reversedDepth}copy(e,t){return super.copy(e,t),this.matrixWorldInverse.copy(e.matrixWorldInverse),this.projectionMatrix.copy(e.projectionMatrix),this.projectionMatrixInverse.copy(e.projectionMatrixInverse),this.coordinateSystem=e.coordinateSystem,this}getWorldDirection(e){return super.getWorldDirection(e).negate()}updateMatrixWorld(e){super.updateMatrixWorld(e),this.matrixWorld.decompose(dc,pc,us),us.x===1&&us.y===1&&us.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(dc,pc,us.set(1,1,1)).invert()}updateWorldMatrix(e,t,n=!1){super.updateWorldMatrix(e,t,n),this.matrixWorld.decompose(dc,pc,us),us.x===1&&us.y===1&&us.z===1?this.matrixWorldInverse.copy(this.matrixWorld).invert():this.matrixWorldInverse.compose(dc,pc,us.set(1,1,1)).invert()}clone(){return new this.constructor().copy(this)}},js=new O,kg=new qe,Bg=new qe,ci=class extends Wa{constructor(e=50,t=1,n=.1,s=2e3){super(),this.isPerspectiveCamera=!0,this.type="PerspectiveCamera",this.fov=e,this.zoom=1,this.near=n,this.far=s,this.focus=10,this.aspect=t,this.view=null,this.filmGauge=35,this.filmOffset=0,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.fov=e.fov,this.zoom=e.zoom,this.near=e.near,this.far=e.far,this.focus=e.focus,this.aspect=e.aspect,this.view=e.view===null?null:Object.assign({},e.view),this.filmGauge=e.filmGauge,this.filmOffset=e.filmOffset,this}setFocalLength(e){let t=.5*this.getFilmHeight()/e;this.fov=No*2*Math.atan(t),this.updateProjectionMatrix()}getFocalLength(){let e=Math.tan(Ro*.5*this.fov);return .5*this.getFilmHeight()/e}getEffectiveFOV(){return No*2*Math.atan(Math.tan(Ro*.5*this.fov)/this.zoom)}getFilmWidth(){return this.filmGauge*Math.min(this.aspect,1)}getFilmHeight(){return this.filmGauge/Math.max(this.aspect,1)}getViewBounds(e,t,n){js.set(-1,-1,.5).applyMatrix4(this.projectionMatrixInverse),t.set(js.x,js.y).multiplyScalar(-e/js.z),js.set(1,1,.5).applyMatrix4(this.projectionMatrixInverse),n.set(js.x,js.y).multiplyScalar(-e/js.z)}getViewSize(e,t){return this.getViewBounds(e,kg,Bg),t.subVectors(Bg,kg)}setViewOffset(e,t,n,s,r,o){this.aspect=e/t,this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let e=this.near,t=e*Math.tan(Ro*.5*this.fov)/this.zoom,n=2*t,s=this.aspect*n,r=-.5*s,o=this.view;if(this.view!==null&&this.view.enabled){let l=o.fullWidth,c=o.fullHeight;r+=o.offsetX*s/l,t-=o.offsetY*n/c,s*=o.width/l,n*=o.height/c}let a=this.filmOffset;a!==0&&(r+=e*a/this.getFilmWidth()),this.projectionMatrix.makePerspective(r,r+s,t,t-n,e,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){let t=super.toJSON(e);return t.object.fov=this.fov,t.object.zoom=this.zoom,t.object.near=this.near,t.object.far=this.far,t.object.focus=this.focus,t.object.aspect=this.aspect,this.view!==null&&(t.object.view=Object.assign({},this.view)),t.object.filmGauge=this.filmGauge,t.object.filmOffset=this.filmOffset,t}};var Xa=class extends Wa{constructor(e=-1,t=1,n=1,s=-1,r=.1,o=2e3){super(),this.isOrthographicCamera=!0,this.type="OrthographicCamera",this.zoom=1,this.view=null,this.left=e,this.right=t,this.top=n,this.bottom=s,this.near=r,this.far=o,this.updateProjectionMatrix()}copy(e,t){return super.copy(e,t),this.left=e.left,this.right=e.right,this.top=e.top,this.bottom=e.bottom,this.near=e.near,this.far=e.far,this.zoom=e.zoom,this.view=e.view===null?null:Object.assign({},e.view),this}setViewOffset(e,t,n,s,r,o){this.view===null&&(this.view={enabled:!0,fullWidth:1,fullHeight:1,offsetX:0,offsetY:0,width:1,height:1}),this.view.enabled=!0,this.view.fullWidth=e,this.view.fullHeight=t,this.view.offsetX=n,this.view.offsetY=s,this.view.width=r,this.view.height=o,this.updateProjectionMatrix()}clearViewOffset(){this.view!==null&&(this.view.enabled=!1),this.updateProjectionMatrix()}updateProjectionMatrix(){let e=(this.right-this.left)/(2*this.zoom),t=(this.top-this.bottom)/(2*this.zoom),n=(this.right+this.left)/2,s=(this.top+this.bottom)/2,r=n-e,o=n+e,a=s+t,l=s-t;if(this.view!==null&&this.view.enabled){let c=(this.right-this.left)/this.view.fullWidth/this.zoom,h=(this.top-this.bottom)/this.view.fullHeight/this.zoom;r+=c*this.view.offsetX,o=r+c*this.view.width,a-=h*this.view.offsetY,l=a-h*this.view.height}this.projectionMatrix.makeOrthographic(r,o,a,l,this.near,this.far,this.coordinateSystem,this.reversedDepth),this.projectionMatrixInverse.copy(this.projectionMatrix).invert()}toJSON(e){let t=super.toJSON(e);return t.object.zoom=this.zoom,t.object.left=this.left,t.object.right=this.right,t.object.top=this.top,t.object.bottom=this.bottom,t.object.near=this.near,t.object.far=this.far,this.view!==null&&(t.object.view=Object.assign({},this.view)),t}},Ff=class extends Zc{constructor(){super(new Xa(-5,5,5,-5,.5,500)),this.isDirectionalLightShadow=!0}},$a=class extends Ga{constructor(e,t){super(e,t),this.isDirectionalLight=!0,this.type="DirectionalLight",this.position.copy(Qn.DEFAULT_UP),this.updateMatrix(),this.target=new Qn,this.shadow=new Ff}dispose(){super.dispose(),this.shadow.dispose()}copy(e){return super.copy(e),this.target=e.target.clone(),this.shadow=e.shadow.clone(),this}toJSON(e){let t=super.toJSON(e);return t.object.shadow=this.shadow.toJSON(),t.object.target=this.target.uuid,t}},qa=class extends Ga{constructor(e,t){super(e,t),this.isAmbientLight=!0,this.type="AmbientLight"}};var To=-90,Co=1,ko=class extends Qn{constructor(e,t,n){super(),this.type="CubeCamera",this.renderTarget=n,this.coordinateSystem=null,this.activeMipmapLevel=0;let s=new ci(To,Co,e,t);s.layers=this.layers,this.add(s);let r=new ci(To,Co,e,t);r.layers=this.layers,this.add(r);let o=new ci(To,Co,e,t);o.layers=this.layers,this.add(o);let a=new ci(To,Co,e,t);a.layers=this.layers,this.add(a);let l=new ci(To,Co,e,t);l.layers=this.layers,this.add(l);let c=new ci(To,Co,e,t);c.layers=this.layers,this.add(c)}updateCoordinateSystem(){let e=this.coordinateSystem,t=this.children.concat(),[n,s,r,o,a,l]=t;for(let c of t)this.remove(c);if(e===ki)n.up.set(0,1,0),n.lookAt(1,0,0),s.up.set(0,1,0),s.lookAt(-1,0,0),r.up.set(0,0,-1),r.lookAt(0,1,0),o.up.set(0,0,1),o.lookAt(0,-1,0),a.up.set(0,1,0),a.lookAt(0,0,1),l.up.set(0,1,0),l.lookAt(0,0,-1);else if(e===Lo)n.up.set(0,-1,0),n.lookAt(-1,0,0),s.up.set(0,-1,0),s.lookAt(1,0,0),r.up.set(0,0,1),r.lookAt(0,1,0),o.up.set(0,0,-1),o.lookAt(0,-1,0),a.up.set(0,-1,0),a.lookAt(0,0,1),l.up.set(0,-1,0),l.lookAt(0,0,-1);else throw new Error("THREE.CubeCamera.updateCoordinateSystem(): Invalid coordinate system: "+e);for(let c of t)this.add(c),c.updateMatrixWorld()}update(e,t){this.parent===null&&this.updateMatrixWorld();let{renderTarget:n,activeMipmapLevel:s}=this;this.coordinateSystem!==e.coordinateSystem&&(this.coordinateSystem=e.coordinateSystem,this.updateCoordinateSystem());let[r,o,a,l,c,h]=this.children,u=e.getRenderTarget(),f=e.getActiveCubeFace(),p=e.getActiveMipmapLevel(),g=e.xr.enabled;e.xr.enabled=!1;let x=n.texture.mipmapsAutoUpdate;n.texture.mipmapsAutoUpdate=!1;let m=!1;e.isWebGLRenderer===!0?m=e.state.buffers.depth.getReversed():m=e.reversedDepthBuffer,e.setRenderTarget(n,0,s),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,r),e.setRenderTarget(n,1,s),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,o),e.setRenderTarget(n,2,s),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,a),e.setRenderTarget(n,3,s),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,l),e.setRenderTarget(n,4,s),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,c),n.texture.mipmapsAutoUpdate=x,e.setRenderTarget(n,5,s),m&&e.autoClear===!1&&e.clearDepth(),e.render(t,h),e.setRenderTarget(u,f,p),e.xr.enabled=g,n.texture.needsPMREMUpdate=!0}},Kc=class extends ci{constructor(e=[]){super(),this.isArrayCamera=!0,this.isMultiViewCamera=!1,this.cameras=e,this.perCameraFrustumCulled=!1}};var yd="\\[\\]\\.:\\/",tM=new RegExp("["+yd+"]","g"),_d="[^"+yd+"]",nM="[^"+yd.replace("\\.","")+"]",iM=/((?:WC+[\/:])*)/.source.replace("WC",_d),sM=/(WCOD+)?/.source.replace("WCOD",nM),rM=/(?:\.(WC+)(?:\[(.+)\])?)?/.source.replace("WC",_d),oM=/\.(WC+)(?:\[(.+)\])?/.source.replace("WC",_d),aM=new RegExp("^"+iM+sM+rM+oM+"$"),lM=["material","materials","bones","map"],Of=class{constructor(e,t,n){let s=n||jt.parseTrackName(t);this._targetGroup=e,this._bindings=e.subscribe_(t,s)}getValue(e,t){this.bind();let n=this._targetGroup.nCachedObjects_,s=this._bindings[n];s!==void 0&&s.getValue(e,t)}setValue(e,t){let n=this._bindings;for(let s=this._targetGroup.nCachedObjects_,r=n.length;s!==r;++s)n[s].setValue(e,t)}bind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,n=e.length;t!==n;++t)e[t].bind()}unbind(){let e=this._bindings;for(let t=this._targetGroup.nCachedObjects_,n=e.length;t!==n;++t)e[t].unbind()}},jt=class i{constructor(e,t,n){this.path=t,this.parsedPath=n||i.parseTrackName(t),this.node=i.findNode(e,this.parsedPath.nodeName),this.rootNode=e,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}static create(e,t,n){return e&&e.isAnimationObjectGroup?new i.Composite(e,t,n):new i(e,t,n)}static sanitizeNodeName(e){return e.replace(/\s/g,"_").replace(tM,"")}static parseTrackName(e){let t=aM.exec(e);if(t===null)throw new Error("THREE.PropertyBinding: Cannot parse trackName: "+e);let n={nodeName:t[2],objectName:t[3],objectIndex:t[4],propertyName:t[5],propertyIndex:t[6]},s=n.nodeName&&n.nodeName.lastIndexOf(".");if(s!==void 0&&s!==-1){let r=n.nodeName.substring(s+1);lM.indexOf(r)!==-1&&(n.nodeName=n.nodeName.substring(0,s),n.objectName=r)}if(n.propertyName===null||n.propertyName.length===0)throw new Error("THREE.PropertyBinding: can not parse propertyName from trackName: "+e);return n}static findNode(e,t){if(t===void 0||t===""||t==="."||t===-1||t===e.name||t===e.uuid)return e;if(e.skeleton){let n=e.skeleton.getBoneByName(t);if(n!==void 0)return n}if(e.children){let n=function(r){for(let o=0;o<r.length;o++){let a=r[o];if(a.name===t||a.uuid===t)return a;let l=n(a.children);if(l)return l}return null},s=n(e.children);if(s)return s}return null}_getValue_unavailable(){}_setValue_unavailable(){}_getValue_direct(e,t){e[t]=this.targetObject[this.propertyName]}_getValue_array(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)e[t++]=n[s]}_getValue_arrayElement(e,t){e[t]=this.resolvedProperty[this.propertyIndex]}_getValue_toArray(e,t){this.resolvedProperty.toArray(e,t)}_setValue_direct(e,t){this.targetObject[this.propertyName]=e[t]}_setValue_direct_setNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.needsUpdate=!0}_setValue_direct_setMatrixWorldNeedsUpdate(e,t){this.targetObject[this.propertyName]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_array(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=e[t++]}_setValue_array_setNeedsUpdate(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=e[t++];this.targetObject.needsUpdate=!0}_setValue_array_setMatrixWorldNeedsUpdate(e,t){let n=this.resolvedProperty;for(let s=0,r=n.length;s!==r;++s)n[s]=e[t++];this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_arrayElement(e,t){this.resolvedProperty[this.propertyIndex]=e[t]}_setValue_arrayElement_setNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.needsUpdate=!0}_setValue_arrayElement_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty[this.propertyIndex]=e[t],this.targetObject.matrixWorldNeedsUpdate=!0}_setValue_fromArray(e,t){this.resolvedProperty.fromArray(e,t)}_setValue_fromArray_setNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.needsUpdate=!0}_setValue_fromArray_setMatrixWorldNeedsUpdate(e,t){this.resolvedProperty.fromArray(e,t),this.targetObject.matrixWorldNeedsUpdate=!0}_getValue_unbound(e,t){this.bind(),this.getValue(e,t)}_setValue_unbound(e,t){this.bind(),this.setValue(e,t)}bind(){let e=this.node,t=this.parsedPath,n=t.objectName,s=t.propertyName,r=t.propertyIndex;if(e||(e=i.findNode(this.rootNode,t.nodeName),this.node=e),this.getValue=this._getValue_unavailable,this.setValue=this._setValue_unavailable,!e){Ye("PropertyBinding: No target node found for track: "+this.path+".");return}if(n){let c=t.objectIndex;switch(n){case"materials":if(!e.material){et("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!e.material.materials){et("PropertyBinding: Can not bind to material.materials as node.material does not have a materials array.",this);return}e=e.material.materials;break;case"bones":if(!e.skeleton){et("PropertyBinding: Can not bind to bones as node does not have a skeleton.",this);return}e=e.skeleton.bones;for(let h=0;h<e.length;h++)if(e[h].name===c){c=h;break}break;case"map":if("map"in e){e=e.map;break}if(!e.material){et("PropertyBinding: Can not bind to material as node does not have a material.",this);return}if(!e.material.map){et("PropertyBinding: Can not bind to material.map as node.material does not have a map.",this);return}e=e.material.map;break;default:if(e[n]===void 0){et("PropertyBinding: Can not bind to objectName of node undefined.",this);return}e=e[n]}if(c!==void 0){if(e[c]===void 0){et("PropertyBinding: Trying to bind to objectIndex of objectName, but is undefined.",this,e);return}e=e[c]}}let o=e[s];if(o===void 0){let c=t.nodeName;et("PropertyBinding: Trying to update property for track: "+c+"."+s+" but it wasn't found.",e);return}let a=this.Versioning.None;this.targetObject=e,e.isMaterial===!0?a=this.Versioning.NeedsUpdate:e.isObject3D===!0&&(a=this.Versioning.MatrixWorldNeedsUpdate);let l=this.BindingType.Direct;if(r!==void 0){if(s==="morphTargetInfluences"){if(!e.geometry){et("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.",this);return}if(!e.geometry.morphAttributes){et("PropertyBinding: Can not bind to morphTargetInfluences because node does not have a geometry.morphAttributes.",this);return}e.morphTargetDictionary[r]!==void 0&&(r=e.morphTargetDictionary[r])}l=this.BindingType.ArrayElement,this.resolvedProperty=o,this.propertyIndex=r}else o.fromArray!==void 0&&o.toArray!==void 0?(l=this.BindingType.HasFromToArray,this.resolvedProperty=o):Array.isArray(o)?(l=this.BindingType.EntireArray,this.resolvedProperty=o):this.propertyName=s;this.getValue=this.GetterByBindingType[l],this.setValue=this.SetterByBindingTypeAndVersioning[l][a]}unbind(){this.node=null,this.getValue=this._getValue_unbound,this.setValue=this._setValue_unbound}};jt.Composite=Of;jt.prototype.BindingType={Direct:0,EntireArray:1,ArrayElement:2,HasFromToArray:3};jt.prototype.Versioning={None:0,NeedsUpdate:1,MatrixWorldNeedsUpdate:2};jt.prototype.GetterByBindingType=[jt.prototype._getValue_direct,jt.prototype._getValue_array,jt.prototype._getValue_arrayElement,jt.prototype._getValue_toArray];jt.prototype.SetterByBindingTypeAndVersioning=[[jt.prototype._setValue_direct,jt.prototype._setValue_direct_setNeedsUpdate,jt.prototype._setValue_direct_setMatrixWorldNeedsUpdate],[jt.prototype._setValue_array,jt.prototype._setValue_array_setNeedsUpdate,jt.prototype._setValue_array_setMatrixWorldNeedsUpdate],[jt.prototype._setValue_arrayElement,jt.prototype._setValue_arrayElement_setNeedsUpdate,jt.prototype._setValue_arrayElement_setMatrixWorldNeedsUpdate],[jt.prototype._setValue_fromArray,jt.prototype._setValue_fromArray_setNeedsUpdate,jt.prototype._setValue_fromArray_setMatrixWorldNeedsUpdate]];var AC=new Float32Array(1);var zg=new Vt,Ya=class{constructor(e,t,n=0,s=1/0){this.ray=new Qs(e,t),this.near=n,this.far=s,this.camera=null,this.layers=new Fo,this.params={Mesh:{},Line:{threshold:1},LOD:{},Points:{threshold:1},Sprite:{}}}set(e,t){this.ray.set(e,t)}setFromCamera(e,t){t.isPerspectiveCamera?(this.ray.origin.setFromMatrixPosition(t.matrixWorld),this.ray.direction.set(e.x,e.y,.5).unproject(t).sub(this.ray.origin).normalize(),this.camera=t):t.isOrthographicCamera?(this.ray.origin.set(e.x,e.y,t.projectionMatrix.elements[14]).unproject(t),this.ray.direction.set(0,0,-1).transformDirection(t.matrixWorld),this.camera=t):et("Raycaster: Unsupported camera type: "+t.type)}setFromXRController(e){return zg.identity().extractRotation(e.matrixWorld),this.ray.origin.setFromMatrixPosition(e.matrixWorld),this.ray.direction.set(0,0,-1).applyMatrix4(zg),this}intersectObject(e,t=!0,n=[]){return kf(e,this,n,t),n.sort(Vg),n}intersectObjects(e,t=!0,n=[]){for(let s=0,r=e.length;s<r;s++)kf(e[s],this,n,t);return n.sort(Vg),n}};function Vg(i,e){return i.distance-e.distance}function kf(i,e,t,n){let s=!0;if(i.layers.test(e.layers)&&i.raycast(e,t)===!1&&(s=!1),s===!0&&n===!0){let r=i.children;for(let o=0,a=r.length;o<a;o++)kf(r[o],e,t,!0)}}var Bo=class{constructor(e=1,t=0,n=0){this.radius=e,this.phi=t,this.theta=n}set(e,t,n){return this.radius=e,this.phi=t,this.theta=n,this}copy(e){return this.radius=e.radius,this.phi=e.phi,this.theta=e.theta,this}makeSafe(){return this.phi=gt(this.phi,1e-6,Math.PI-1e-6),this}setFromVector3(e){return this.setFromCartesianCoords(e.x,e.y,e.z)}setFromCartesianCoords(e,t,n){return this.radius=Math.sqrt(e*e+t*t+n*n),this.radius===0?(this.theta=0,this.phi=0):(this.theta=Math.atan2(e,n),this.phi=Math.acos(gt(t/this.radius,-1,1))),this}clone(){return new this.constructor().copy(this)}};var Bf=class{static{this.prototype.isMatrix2=!0}constructor(e,t,n,s){this.elements=[1,0,0,1],e!==void 0&&this.set(e,t,n,s)}identity(){return this.set(1,0,0,1),this}fromArray(e,t=0){for(let n=0;n<4;n++)this.elements[n]=e[n+t];return this}set(e,t,n,s){let r=this.elements;return r[0]=e,r[2]=t,r[1]=n,r[3]=s,this}};var Za=class extends Zi{constructor(e,t=null){super(),this.object=e,this.domElement=t,this.enabled=!0,this.state=-1,this.keys={},this.mouseButtons={LEFT:null,MIDDLE:null,RIGHT:null},this.touches={ONE:null,TWO:null}}connect(e){this.domElement!==null&&this.disconnect(),this.domElement=e}disconnect(){}dispose(){}update(){}};function xd(i,e,t,n){let s=cM(n);switch(t){case sd:return i*e;case od:return i*e/s.components*s.byteLength;case sh:return i*e/s.components*s.byteLength;case hr:return i*e*2/s.components*s.byteLength;case rh:return i*e*2/s.components*s.byteLength;case rd:return i*e*3/s.components*s.byteLength;case Qi:return i*e*4/s.components*s.byteLength;case oh:return i*e*4/s.components*s.byteLength;case ja:case Qa:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*8;case el:case tl:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*16;case lh:case hh:return Math.max(i,16)*Math.max(e,8)/4;case ah:case ch:return Math.max(i,8)*Math.max(e,8)/2;case uh:case fh:case ph:case mh:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*8;case dh:case nl:case gh:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*16;case yh:return Math.floor((i+3)/4)*Math.floor((e+3)/4)*16;case _h:return Math.floor((i+4)/5)*Math.floor((e+3)/4)*16;case xh:return Math.floor((i+4)/5)*Math.floor((e+4)/5)*16;case vh:return Math.floor((i+5)/6)*Math.floor((e+4)/5)*16;case bh:return Math.floor((i+5)/6)*Math.floor((e+5)/6)*16;case Mh:return Math.floor((i+7)/8)*Math.floor((e+4)/5)*16;case Sh:return Math.floor((i+7)/8)*Math.floor((e+5)/6)*16;case wh:return Math.floor((i+7)/8)*Math.floor((e+7)/8)*16;case Ah:return Math.floor((i+9)/10)*Math.floor((e+4)/5)*16;case Eh:return Math.floor((i+9)/10)*Math.floor((e+5)/6)*16;case Th:return Math.floor((i+9)/10)*Math.floor((e+7)/8)*16;case Ch:return Math.floor((i+9)/10)*Math.floor((e+9)/10)*16;case Rh:return Math.floor((i+11)/12)*Math.floor((e+9)/10)*16;case Ih:return Math.floor((i+11)/12)*Math.floor((e+11)/12)*16;case Ph:case Lh:case Dh:return Math.ceil(i/4)*Math.ceil(e/4)*16;case Nh:case Uh:return Math.ceil(i/4)*Math.ceil(e/4)*8;case il:case Fh:return Math.ceil(i/4)*Math.ceil(e/4)*16}throw new Error(`Unable to determine texture byte length for ${t} format.`)}function cM(i){switch(i){case pi:case ed:return{byteLength:1,components:1};case Go:case td:case ji:return{byteLength:2,components:1};case nh:case ih:return{byteLength:2,components:4};case Ki:case th:case Ji:return{byteLength:4,components:1};case nd:case id:return{byteLength:4,components:3}}throw new Error(`THREE.TextureUtils: Unknown texture type ${i}.`)}typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("register",{detail:{revision:"187"}}));typeof window<"u"&&(window.__THREE__?Ye("WARNING: Multiple instances of Three.js being imported."):window.__THREE__="187");function j0(){let i=null,e=!1,t=null,n=null;function s(r,o){n=i.requestAnimationFrame(s),t(r,o)}return{start:function(){e!==!0&&t!==null&&i!==null&&(n=i.requestAnimationFrame(s),e=!0)},stop:function(){i!==null&&i.cancelAnimationFrame(n),e=!1},setAnimationLoop:function(r){t=r},setContext:function(r){i=r}}}function uM(i){let e=new WeakMap;function t(a,l){let c=a.array,h=a.usage,u=c.byteLength,f=i.createBuffer();i.bindBuffer(l,f),i.bufferData(l,c,h),a.onUploadCallback();let p;if(c instanceof Float32Array)p=i.FLOAT;else if(typeof Float16Array<"u"&&c instanceof Float16Array)p=i.HALF_FLOAT;else if(c instanceof Uint16Array)a.isFloat16BufferAttribute?p=i.HALF_FLOAT:p=i.UNSIGNED_SHORT;else if(c instanceof Int16Array)p=i.SHORT;else if(c instanceof Uint32Array)p=i.UNSIGNED_INT;else if(c instanceof Int32Array)p=i.INT;else if(c instanceof Int8Array)p=i.BYTE;else if(c instanceof Uint8Array)p=i.UNSIGNED_BYTE;else if(c instanceof Uint8ClampedArray)p=i.UNSIGNED_BYTE;else throw new Error("THREE.WebGLAttributes: Unsupported buffer data format: "+c);return{buffer:f,type:p,bytesPerElement:c.BYTES_PER_ELEMENT,version:a.version,size:u}}function n(a,l,c){let h=l.array,u=l.updateRanges;if(i.bindBuffer(c,a),u.length===0)i.bufferSubData(c,0,h);else{u.sort((p,g)=>p.start-g.start);let f=0;for(let p=1;p<u.length;p++){let g=u[f],x=u[p];x.start<=g.start+g.count+1?g.count=Math.max(g.count,x.start+x.count-g.start):(++f,u[f]=x)}u.length=f+1;for(let p=0,g=u.length;p<g;p++){let x=u[p];i.bufferSubData(c,x.start*h.BYTES_PER_ELEMENT,h,x.start,x.count)}l.clearUpdateRanges()}l.onUploadCallback()}function s(a){return a.isInterleavedBufferAttribute&&(a=a.data),e.get(a)}function r(a){a.isInterleavedBufferAttribute&&(a=a.data);let l=e.get(a);l&&(i.deleteBuffer(l.buffer),e.delete(a))}function o(a,l){if(a.isInterleavedBufferAttribute&&(a=a.data),a.isGLBufferAttribute){let h=e.get(a);(!h||h.version<a.version)&&e.set(a,{buffer:a.buffer,type:a.type,bytesPerElement:a.elementSize,version:a.version});return}let c=e.get(a);if(c===void 0)e.set(a,t(a,l));else if(c.version<a.version){if(c.size!==a.array.byteLength)throw new Error("THREE.WebGLAttributes: The size of the buffer attribute's array buffer does not match the original size. Resizing buffer attributes is not supported.");n(c.buffer,a,l),c.version=a.version}}return{get:s,remove:r,update:o}}var fM=`#ifdef USE_ALPHAHASH
	if ( diffuseColor.a < getAlphaHashThreshold( vPosition ) ) discard;
#endif`,dM=`#ifdef USE_ALPHAHASH
	const float ALPHA_HASH_SCALE = 0.05;
	float hash2D( vec2 value ) {
		return fract( 1.0e4 * sin( 17.0 * value.x + 0.1 * value.y ) * ( 0.1 + abs( sin( 13.0 * value.y + value.x ) ) ) );
	}
	float hash3D( vec3 value ) {
		return hash2D( vec2( hash2D( value.xy ), value.z ) );
	}
	float getAlphaHashThreshold( vec3 position ) {
		float maxDeriv = max(
			length( dFdx( position.xyz ) ),
			length( dFdy( position.xyz ) )
		);
		float pixScale = 1.0 / ( ALPHA_HASH_SCALE * maxDeriv );
		vec2 pixScales = vec2(
			exp2( floor( log2( pixScale ) ) ),
			exp2( ceil( log2( pixScale ) ) )
		);
		vec2 alpha = vec2(
			hash3D( floor( pixScales.x * position.xyz ) ),
			hash3D( floor( pixScales.y * position.xyz ) )
		);
		float lerpFactor = fract( log2( pixScale ) );
		float x = ( 1.0 - lerpFactor ) * alpha.x + lerpFactor * alpha.y;
		float a = min( lerpFactor, 1.0 - lerpFactor );
		vec3 cases = vec3(
			x * x / ( 2.0 * a * ( 1.0 - a ) ),
			( x - 0.5 * a ) / ( 1.0 - a ),
			1.0 - ( ( 1.0 - x ) * ( 1.0 - x ) / ( 2.0 * a * ( 1.0 - a ) ) )
		);
		float threshold = ( x < ( 1.0 - a ) )
			? ( ( x < a ) ? cases.x : cases.y )
			: cases.z;
		return clamp( threshold , 1.0e-6, 1.0 );
	}
#endif`,pM=`#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, vAlphaMapUv ).g;
#endif`,mM=`#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,gM=`#ifdef USE_ALPHATEST
	#ifdef ALPHA_TO_COVERAGE
	diffuseColor.a = smoothstep( alphaTest, alphaTest + fwidth( diffuseColor.a ), diffuseColor.a );
	if ( diffuseColor.a == 0.0 ) discard;
	#else
	if ( diffuseColor.a < alphaTest ) discard;
	#endif
#endif`,yM=`#ifdef USE_ALPHATEST
	uniform float alphaTest;
#endif`,_M=`#ifdef USE_AOMAP
	float ambientOcclusion = ( texture2D( aoMap, vAoMapUv ).r - 1.0 ) * aoMapIntensity + 1.0;
	reflectedLight.indirectDiffuse *= ambientOcclusion;
	#if defined( USE_CLEARCOAT ) 
		clearcoatSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_SHEEN ) 
		sheenSpecularIndirect *= ambientOcclusion;
	#endif
	#if defined( USE_ENVMAP ) && defined( STANDARD )
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		reflectedLight.indirectSpecular *= computeSpecularOcclusion( dotNV, ambientOcclusion, material.roughness );
	#endif
#endif`,xM=`#ifdef USE_AOMAP
	uniform sampler2D aoMap;
	uniform float aoMapIntensity;
#endif`,vM=`#ifdef USE_BATCHING
	#if ! defined( GL_ANGLE_multi_draw )
	#define gl_DrawID _gl_DrawID
	uniform int _gl_DrawID;
	#endif
	uniform highp sampler2D batchingTexture;
	uniform highp usampler2D batchingIdTexture;
	mat4 getBatchingMatrix( const in float i ) {
		int size = textureSize( batchingTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( batchingTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( batchingTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( batchingTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( batchingTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
	float getIndirectIndex( const in int i ) {
		int size = textureSize( batchingIdTexture, 0 ).x;
		int x = i % size;
		int y = i / size;
		return float( texelFetch( batchingIdTexture, ivec2( x, y ), 0 ).r );
	}
#endif
#ifdef USE_BATCHING_COLOR
	uniform sampler2D batchingColorTexture;
	vec4 getBatchingColor( const in float i ) {
		int size = textureSize( batchingColorTexture, 0 ).x;
		int j = int( i );
		int x = j % size;
		int y = j / size;
		return texelFetch( batchingColorTexture, ivec2( x, y ), 0 );
	}
#endif`,bM=`#ifdef USE_BATCHING
	mat4 batchingMatrix = getBatchingMatrix( getIndirectIndex( gl_DrawID ) );
#endif`,MM=`vec3 transformed = vec3( position );
#ifdef USE_ALPHAHASH
	vPosition = vec3( position );
#endif`,SM=`vec3 objectNormal = vec3( normal );
#ifdef USE_TANGENT
	vec3 objectTangent = vec3( tangent.xyz );
#endif`,wM=`float G_BlinnPhong_Implicit( ) {
	return 0.25;
}
float D_BlinnPhong( const in float shininess, const in float dotNH ) {
	return RECIPROCAL_PI * ( shininess * 0.5 + 1.0 ) * pow( dotNH, shininess );
}
vec3 BRDF_BlinnPhong( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 specularColor, const in float shininess ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( specularColor, 1.0, dotVH );
	float G = G_BlinnPhong_Implicit( );
	float D = D_BlinnPhong( shininess, dotNH );
	return F * ( G * D );
} // validated`,AM=`#ifdef USE_IRIDESCENCE
	const mat3 XYZ_TO_REC709 = mat3(
		 3.2404542, -0.9692660,  0.0556434,
		-1.5371385,  1.8760108, -0.2040259,
		-0.4985314,  0.0415560,  1.0572252
	);
	vec3 Fresnel0ToIor( vec3 fresnel0 ) {
		vec3 sqrtF0 = sqrt( fresnel0 );
		return ( vec3( 1.0 ) + sqrtF0 ) / ( vec3( 1.0 ) - sqrtF0 );
	}
	vec3 IorToFresnel0( vec3 transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - vec3( incidentIor ) ) / ( transmittedIor + vec3( incidentIor ) ) );
	}
	float IorToFresnel0( float transmittedIor, float incidentIor ) {
		return pow2( ( transmittedIor - incidentIor ) / ( transmittedIor + incidentIor ));
	}
	vec3 evalSensitivity( float OPD, vec3 shift ) {
		float phase = 2.0 * PI * OPD * 1.0e-9;
		vec3 val = vec3( 5.4856e-13, 4.4201e-13, 5.2481e-13 );
		vec3 pos = vec3( 1.6810e+06, 1.7953e+06, 2.2084e+06 );
		vec3 var = vec3( 4.3278e+09, 9.3046e+09, 6.6121e+09 );
		vec3 xyz = val * sqrt( 2.0 * PI * var ) * cos( pos * phase + shift ) * exp( - pow2( phase ) * var );
		xyz.x += 9.7470e-14 * sqrt( 2.0 * PI * 4.5282e+09 ) * cos( 2.2399e+06 * phase + shift[ 0 ] ) * exp( - 4.5282e+09 * pow2( phase ) );
		xyz /= 1.0685e-7;
		vec3 rgb = XYZ_TO_REC709 * xyz;
		return rgb;
	}
	vec3 evalIridescence( float outsideIOR, float eta2, float cosTheta1, float thinFilmThickness, vec3 baseF0 ) {
		vec3 I;
		float iridescenceIOR = mix( outsideIOR, eta2, smoothstep( 0.0, 0.03, thinFilmThickness ) );
		float sinTheta2Sq = pow2( outsideIOR / iridescenceIOR ) * ( 1.0 - pow2( cosTheta1 ) );
		float cosTheta2Sq = 1.0 - sinTheta2Sq;
		if ( cosTheta2Sq < 0.0 ) {
			return vec3( 1.0 );
		}
		float cosTheta2 = sqrt( cosTheta2Sq );
		float R0 = IorToFresnel0( iridescenceIOR, outsideIOR );
		float R12 = F_Schlick( R0, 1.0, cosTheta1 );
		float T121 = 1.0 - R12;
		float phi12 = 0.0;
		if ( iridescenceIOR < outsideIOR ) phi12 = PI;
		float phi21 = PI - phi12;
		vec3 baseIOR = Fresnel0ToIor( clamp( baseF0, 0.0, 0.9999 ) );		vec3 R1 = IorToFresnel0( baseIOR, iridescenceIOR );
		vec3 R23 = F_Schlick( R1, 1.0, cosTheta2 );
		vec3 phi23 = vec3( 0.0 );
		if ( baseIOR[ 0 ] < iridescenceIOR ) phi23[ 0 ] = PI;
		if ( baseIOR[ 1 ] < iridescenceIOR ) phi23[ 1 ] = PI;
		if ( baseIOR[ 2 ] < iridescenceIOR ) phi23[ 2 ] = PI;
		float OPD = 2.0 * iridescenceIOR * thinFilmThickness * cosTheta2;
		vec3 phi = vec3( phi21 ) + phi23;
		vec3 R123 = clamp( R12 * R23, 1e-5, 0.9999 );
		vec3 r123 = sqrt( R123 );
		vec3 Rs = pow2( T121 ) * R23 / ( vec3( 1.0 ) - R123 );
		vec3 C0 = R12 + Rs;
		I = C0;
		vec3 Cm = Rs - T121;
		for ( int m = 1; m <= 2; ++ m ) {
			Cm *= r123;
			vec3 Sm = 2.0 * evalSensitivity( float( m ) * OPD, float( m ) * phi );
			I += Cm * Sm;
		}
		return max( I, vec3( 0.0 ) );
	}
#endif`,EM=`#ifdef USE_BUMPMAP
	uniform sampler2D bumpMap;
	uniform float bumpScale;
	vec2 dHdxy_fwd() {
		vec2 dSTdx = dFdx( vBumpMapUv );
		vec2 dSTdy = dFdy( vBumpMapUv );
		float Hll = bumpScale * texture2D( bumpMap, vBumpMapUv ).x;
		float dBx = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdx ).x - Hll;
		float dBy = bumpScale * texture2D( bumpMap, vBumpMapUv + dSTdy ).x - Hll;
		return vec2( dBx, dBy );
	}
	vec3 perturbNormalArb( vec3 surf_pos, vec3 surf_norm, vec2 dHdxy, float faceDirection ) {
		vec3 vSigmaX = normalize( dFdx( surf_pos.xyz ) );
		vec3 vSigmaY = normalize( dFdy( surf_pos.xyz ) );
		vec3 vN = surf_norm;
		vec3 R1 = cross( vSigmaY, vN );
		vec3 R2 = cross( vN, vSigmaX );
		float fDet = dot( vSigmaX, R1 ) * faceDirection;
		vec3 vGrad = sign( fDet ) * ( dHdxy.x * R1 + dHdxy.y * R2 );
		return normalize( abs( fDet ) * surf_norm - vGrad );
	}
#endif`,TM=`#if NUM_CLIPPING_PLANES > 0
	vec4 plane;
	#ifdef ALPHA_TO_COVERAGE
		float distanceToPlane, distanceGradient;
		float clipOpacity = 1.0;
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
			distanceGradient = fwidth( distanceToPlane ) / 2.0;
			clipOpacity *= smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			if ( clipOpacity == 0.0 ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			float unionClipOpacity = 1.0;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				distanceToPlane = - dot( vClipPosition, plane.xyz ) + plane.w;
				distanceGradient = fwidth( distanceToPlane ) / 2.0;
				unionClipOpacity *= 1.0 - smoothstep( - distanceGradient, distanceGradient, distanceToPlane );
			}
			#pragma unroll_loop_end
			clipOpacity *= 1.0 - unionClipOpacity;
		#endif
		diffuseColor.a *= clipOpacity;
		if ( diffuseColor.a == 0.0 ) discard;
	#else
		#pragma unroll_loop_start
		for ( int i = 0; i < UNION_CLIPPING_PLANES; i ++ ) {
			plane = clippingPlanes[ i ];
			if ( dot( vClipPosition, plane.xyz ) > plane.w ) discard;
		}
		#pragma unroll_loop_end
		#if UNION_CLIPPING_PLANES < NUM_CLIPPING_PLANES
			bool clipped = true;
			#pragma unroll_loop_start
			for ( int i = UNION_CLIPPING_PLANES; i < NUM_CLIPPING_PLANES; i ++ ) {
				plane = clippingPlanes[ i ];
				clipped = ( dot( vClipPosition, plane.xyz ) > plane.w ) && clipped;
			}
			#pragma unroll_loop_end
			if ( clipped ) discard;
		#endif
	#endif
#endif`,CM=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
	uniform vec4 clippingPlanes[ NUM_CLIPPING_PLANES ];
#endif`,RM=`#if NUM_CLIPPING_PLANES > 0
	varying vec3 vClipPosition;
#endif`,IM=`#if NUM_CLIPPING_PLANES > 0
	vClipPosition = - mvPosition.xyz;
#endif`,PM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	diffuseColor *= vColor;
#endif`,LM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA )
	varying vec4 vColor;
#endif`,DM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	varying vec4 vColor;
#endif`,NM=`#if defined( USE_COLOR ) || defined( USE_COLOR_ALPHA ) || defined( USE_INSTANCING_COLOR ) || defined( USE_BATCHING_COLOR )
	vColor = vec4( 1.0 );
#endif
#ifdef USE_COLOR_ALPHA
	vColor *= color;
#elif defined( USE_COLOR )
	vColor.rgb *= color;
#endif
#ifdef USE_INSTANCING_COLOR
	vColor.rgb *= instanceColor.rgb;
#endif
#ifdef USE_BATCHING_COLOR
	vColor *= getBatchingColor( getIndirectIndex( gl_DrawID ) );
#endif`,UM=`#define PI 3.141592653589793
#define PI2 6.283185307179586
#define PI_HALF 1.5707963267948966
#define RECIPROCAL_PI 0.3183098861837907
#define RECIPROCAL_PI2 0.15915494309189535
#define EPSILON 1e-6
#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
#define whiteComplement( a ) ( 1.0 - saturate( a ) )
float pow2( const in float x ) { return x*x; }
vec3 pow2( const in vec3 x ) { return x*x; }
float pow3( const in float x ) { return x*x*x; }
float pow4( const in float x ) { float x2 = x*x; return x2*x2; }
float max3( const in vec3 v ) { return max( max( v.x, v.y ), v.z ); }
float average( const in vec3 v ) { return dot( v, vec3( 0.3333333 ) ); }
highp float rand( const in vec2 uv ) {
	const highp float a = 12.9898, b = 78.233, c = 43758.5453;
	highp float dt = dot( uv.xy, vec2( a,b ) ), sn = mod( dt, PI );
	return fract( sin( sn ) * c );
}
#ifdef HIGH_PRECISION
	float precisionSafeLength( vec3 v ) { return length( v ); }
#else
	float precisionSafeLength( vec3 v ) {
		float maxComponent = max3( abs( v ) );
		return length( v / maxComponent ) * maxComponent;
	}
#endif
struct IncidentLight {
	vec3 color;
	vec3 direction;
	bool visible;
};
struct ReflectedLight {
	vec3 directDiffuse;
	vec3 directSpecular;
	vec3 indirectDiffuse;
	vec3 indirectSpecular;
};
#ifdef USE_ALPHAHASH
	varying vec3 vPosition;
#endif
vec3 transformDirection( in vec3 dir, in mat4 matrix ) {
	return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );
}
#define inverseTransformDirection transformDirectionByInverseViewMatrix
vec3 transformNormalByInverseViewMatrix( in vec3 normal, in mat4 viewMatrix ) {
	return normalize( ( vec4( normal, 0.0 ) * viewMatrix ).xyz );
}
vec3 transformDirectionByInverseViewMatrix( in vec3 dir, in mat4 viewMatrix ) {
	return normalize( ( vec4( dir, 0.0 ) * viewMatrix ).xyz );
}
bool isPerspectiveMatrix( mat4 m ) {
	return m[ 2 ][ 3 ] == - 1.0;
}
vec2 equirectUv( in vec3 dir ) {
	float u = atan( dir.z, dir.x ) * RECIPROCAL_PI2 + 0.5;
	float v = asin( clamp( dir.y, - 1.0, 1.0 ) ) * RECIPROCAL_PI + 0.5;
	return vec2( u, v );
}
vec3 BRDF_Lambert( const in vec3 diffuseColor ) {
	return RECIPROCAL_PI * diffuseColor;
}
vec3 F_Schlick( const in vec3 f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
}
float F_Schlick( const in float f0, const in float f90, const in float dotVH ) {
	float fresnel = exp2( ( - 5.55473 * dotVH - 6.98316 ) * dotVH );
	return f0 * ( 1.0 - fresnel ) + ( f90 * fresnel );
} // validated`,FM=`vec3 transformedNormal = objectNormal;
#ifdef USE_TANGENT
	vec3 transformedTangent = objectTangent;
#endif
#ifdef USE_BATCHING
	mat3 bm = mat3( batchingMatrix );
	transformedNormal /= vec3( dot( bm[ 0 ], bm[ 0 ] ), dot( bm[ 1 ], bm[ 1 ] ), dot( bm[ 2 ], bm[ 2 ] ) );
	transformedNormal = bm * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = bm * transformedTangent;
	#endif
#endif
#ifdef USE_INSTANCING
	mat3 im = mat3( instanceMatrix );
	transformedNormal /= vec3( dot( im[ 0 ], im[ 0 ] ), dot( im[ 1 ], im[ 1 ] ), dot( im[ 2 ], im[ 2 ] ) );
	transformedNormal = im * transformedNormal;
	#ifdef USE_TANGENT
		transformedTangent = im * transformedTangent;
	#endif
#endif
transformedNormal = normalMatrix * transformedNormal;
#ifdef FLIP_SIDED
	transformedNormal = - transformedNormal;
#endif
#ifdef USE_TANGENT
	transformedTangent = ( modelViewMatrix * vec4( transformedTangent, 0.0 ) ).xyz;
#endif`,OM=`#ifdef USE_DISPLACEMENTMAP
	uniform sampler2D displacementMap;
	uniform float displacementScale;
	uniform float displacementBias;
#endif`,kM=`#ifdef USE_DISPLACEMENTMAP
	transformed += normalize( objectNormal ) * ( texture2D( displacementMap, vDisplacementMapUv ).x * displacementScale + displacementBias );
#endif`,BM=`#ifdef USE_EMISSIVEMAP
	vec4 emissiveColor = texture2D( emissiveMap, vEmissiveMapUv );
	#ifdef DECODE_VIDEO_TEXTURE_EMISSIVE
		emissiveColor = sRGBTransferEOTF( emissiveColor );
	#endif
	totalEmissiveRadiance *= emissiveColor.rgb;
#endif`,zM=`#ifdef USE_EMISSIVEMAP
	uniform sampler2D emissiveMap;
#endif`,VM="gl_FragColor = linearToOutputTexel( gl_FragColor );",HM=`vec4 LinearTransferOETF( in vec4 value ) {
	return value;
}
vec4 sRGBTransferEOTF( in vec4 value ) {
	return vec4( mix( pow( value.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), value.rgb * 0.0773993808, vec3( lessThanEqual( value.rgb, vec3( 0.04045 ) ) ) ), value.a );
}
vec4 sRGBTransferOETF( in vec4 value ) {
	return vec4( mix( pow( value.rgb, vec3( 0.41666 ) ) * 1.055 - vec3( 0.055 ), value.rgb * 12.92, vec3( lessThanEqual( value.rgb, vec3( 0.0031308 ) ) ) ), value.a );
}`,GM=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vec3 cameraToFrag;
		if ( isOrthographic ) {
			cameraToFrag = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToFrag = normalize( vWorldPosition - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vec3 reflectVec = reflect( cameraToFrag, worldNormal );
		#else
			vec3 reflectVec = refract( cameraToFrag, worldNormal, refractionRatio );
		#endif
	#else
		vec3 reflectVec = vReflect;
	#endif
	#ifdef ENVMAP_TYPE_CUBE
		vec4 envColor = textureCube( envMap, envMapRotation * reflectVec );
		#ifdef ENVMAP_BLENDING_MULTIPLY
			outgoingLight = mix( outgoingLight, outgoingLight * envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_MIX )
			outgoingLight = mix( outgoingLight, envColor.xyz, specularStrength * reflectivity );
		#elif defined( ENVMAP_BLENDING_ADD )
			outgoingLight += envColor.xyz * specularStrength * reflectivity;
		#endif
	#endif
#endif`,WM=`#ifdef USE_ENVMAP
	uniform float envMapIntensity;
	uniform mat3 envMapRotation;
	uniform samplerCube envMap;
	#ifdef ENVMAP_TYPE_PMREM
		float roughnessToMip( const in float roughness ) {
			float r = clamp( roughness, 0.0, 1.0 );
			return ENVMAP_MAX_LOD * r * ( 2.0 - r );
		}
	#endif
#endif`,XM=`#ifdef USE_ENVMAP
	uniform float reflectivity;
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		varying vec3 vWorldPosition;
		uniform float refractionRatio;
	#else
		varying vec3 vReflect;
	#endif
#endif`,$M=`#ifdef USE_ENVMAP
	#if defined( USE_BUMPMAP ) || defined( USE_NORMALMAP ) || defined( PHONG ) || defined( LAMBERT )
		#define ENV_WORLDPOS
	#endif
	#ifdef ENV_WORLDPOS
		
		varying vec3 vWorldPosition;
	#else
		varying vec3 vReflect;
		uniform float refractionRatio;
	#endif
#endif`,qM=`#ifdef USE_ENVMAP
	#ifdef ENV_WORLDPOS
		vWorldPosition = worldPosition.xyz;
	#else
		vec3 cameraToVertex;
		if ( isOrthographic ) {
			cameraToVertex = normalize( vec3( - viewMatrix[ 0 ][ 2 ], - viewMatrix[ 1 ][ 2 ], - viewMatrix[ 2 ][ 2 ] ) );
		} else {
			cameraToVertex = normalize( worldPosition.xyz - cameraPosition );
		}
		vec3 worldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
		#ifdef ENVMAP_MODE_REFLECTION
			vReflect = reflect( cameraToVertex, worldNormal );
		#else
			vReflect = refract( cameraToVertex, worldNormal, refractionRatio );
		#endif
	#endif
#endif`,YM=`#ifdef USE_FOG
	vFogDepth = - mvPosition.z;
#endif`,ZM=`#ifdef USE_FOG
	varying float vFogDepth;
#endif`,KM=`#ifdef USE_FOG
	#ifdef FOG_EXP2
		float fogFactor = 1.0 - exp( - fogDensity * fogDensity * vFogDepth * vFogDepth );
	#else
		float fogFactor = smoothstep( fogNear, fogFar, vFogDepth );
	#endif
	gl_FragColor.rgb = mix( gl_FragColor.rgb, fogColor, fogFactor );
#endif`,JM=`#ifdef USE_FOG
	uniform vec3 fogColor;
	varying float vFogDepth;
	#ifdef FOG_EXP2
		uniform float fogDensity;
	#else
		uniform float fogNear;
		uniform float fogFar;
	#endif
#endif`,jM=`#ifdef USE_GRADIENTMAP
	uniform sampler2D gradientMap;
#endif
vec3 getGradientIrradiance( vec3 normal, vec3 lightDirection ) {
	float dotNL = dot( normal, lightDirection );
	vec2 coord = vec2( dotNL * 0.5 + 0.5, 0.0 );
	#ifdef USE_GRADIENTMAP
		return vec3( texture2D( gradientMap, coord ).r );
	#else
		vec2 fw = fwidth( coord ) * 0.5;
		return mix( vec3( 0.7 ), vec3( 1.0 ), smoothstep( 0.7 - fw.x, 0.7 + fw.x, coord.x ) );
	#endif
}`,QM=`#ifdef USE_LIGHTMAP
	uniform sampler2D lightMap;
	uniform float lightMapIntensity;
#endif`,eS=`LambertMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularStrength = specularStrength;`,tS=`varying vec3 vViewPosition;
struct LambertMaterial {
	vec3 diffuseColor;
	float specularStrength;
};
void RE_Direct_Lambert( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Lambert( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in LambertMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Lambert
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Lambert`,nS=`uniform bool receiveShadow;
uniform vec3 ambientLightColor;
#if defined( USE_LIGHT_PROBES )
	uniform vec3 lightProbe[ 9 ];
#endif
vec3 shGetIrradianceAt( in vec3 normal, in vec3 shCoefficients[ 9 ] ) {
	float x = normal.x, y = normal.y, z = normal.z;
	vec3 result = shCoefficients[ 0 ] * 0.886227;
	result += shCoefficients[ 1 ] * 2.0 * 0.511664 * y;
	result += shCoefficients[ 2 ] * 2.0 * 0.511664 * z;
	result += shCoefficients[ 3 ] * 2.0 * 0.511664 * x;
	result += shCoefficients[ 4 ] * 2.0 * 0.429043 * x * y;
	result += shCoefficients[ 5 ] * 2.0 * 0.429043 * y * z;
	result += shCoefficients[ 6 ] * ( 0.743125 * z * z - 0.247708 );
	result += shCoefficients[ 7 ] * 2.0 * 0.429043 * x * z;
	result += shCoefficients[ 8 ] * 0.429043 * ( x * x - y * y );
	return result;
}
vec3 getLightProbeIrradiance( const in vec3 lightProbe[ 9 ], const in vec3 normal ) {
	vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec3 irradiance = shGetIrradianceAt( worldNormal, lightProbe );
	return irradiance;
}
vec3 getAmbientLightIrradiance( const in vec3 ambientLightColor ) {
	vec3 irradiance = ambientLightColor;
	return irradiance;
}
float getDistanceAttenuation( const in float lightDistance, const in float cutoffDistance, const in float decayExponent ) {
	float distanceFalloff = 1.0 / max( pow( lightDistance, decayExponent ), 0.01 );
	if ( cutoffDistance > 0.0 ) {
		distanceFalloff *= pow2( saturate( 1.0 - pow4( lightDistance / cutoffDistance ) ) );
	}
	return distanceFalloff;
}
float getSpotAttenuation( const in float coneCosine, const in float penumbraCosine, const in float angleCosine ) {
	return smoothstep( coneCosine, penumbraCosine, angleCosine );
}
#if NUM_SUN_LIGHTS > 0
	struct SunLight {
		vec3 direction;
		vec3 color;
	};
	uniform SunLight sunLights[ NUM_SUN_LIGHTS ];
	void getSunLightInfo( const in SunLight sunLight, out IncidentLight light ) {
		light.color = sunLight.color;
		light.direction = sunLight.direction;
		light.visible = true;
	}
#endif
#if NUM_DIR_LIGHTS > 0
	struct DirectionalLight {
		vec3 direction;
		vec3 color;
	};
	uniform DirectionalLight directionalLights[ NUM_DIR_LIGHTS ];
	void getDirectionalLightInfo( const in DirectionalLight directionalLight, out IncidentLight light ) {
		light.color = directionalLight.color;
		light.direction = directionalLight.direction;
		light.visible = true;
	}
#endif
#if NUM_POINT_LIGHTS > 0
	struct PointLight {
		vec3 position;
		vec3 color;
		float distance;
		float decay;
	};
	uniform PointLight pointLights[ NUM_POINT_LIGHTS ];
	void getPointLightInfo( const in PointLight pointLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = pointLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float lightDistance = length( lVector );
		light.color = pointLight.color;
		light.color *= getDistanceAttenuation( lightDistance, pointLight.distance, pointLight.decay );
		light.visible = ( light.color != vec3( 0.0 ) );
	}
#endif
#if NUM_SPOT_LIGHTS > 0
	struct SpotLight {
		vec3 position;
		vec3 direction;
		vec3 color;
		float distance;
		float decay;
		float coneCos;
		float penumbraCos;
	};
	uniform SpotLight spotLights[ NUM_SPOT_LIGHTS ];
	void getSpotLightInfo( const in SpotLight spotLight, const in vec3 geometryPosition, out IncidentLight light ) {
		vec3 lVector = spotLight.position - geometryPosition;
		light.direction = normalize( lVector );
		float angleCos = dot( light.direction, spotLight.direction );
		float spotAttenuation = getSpotAttenuation( spotLight.coneCos, spotLight.penumbraCos, angleCos );
		if ( spotAttenuation > 0.0 ) {
			float lightDistance = length( lVector );
			light.color = spotLight.color * spotAttenuation;
			light.color *= getDistanceAttenuation( lightDistance, spotLight.distance, spotLight.decay );
			light.visible = ( light.color != vec3( 0.0 ) );
		} else {
			light.color = vec3( 0.0 );
			light.visible = false;
		}
	}
#endif
#if NUM_RECT_AREA_LIGHTS > 0
	struct RectAreaLight {
		vec3 color;
		vec3 position;
		vec3 halfWidth;
		vec3 halfHeight;
	};
	uniform sampler2D ltc_1;	uniform sampler2D ltc_2;
	uniform RectAreaLight rectAreaLights[ NUM_RECT_AREA_LIGHTS ];
#endif
#if NUM_HEMI_LIGHTS > 0
	struct HemisphereLight {
		vec3 direction;
		vec3 skyColor;
		vec3 groundColor;
	};
	uniform HemisphereLight hemisphereLights[ NUM_HEMI_LIGHTS ];
	vec3 getHemisphereLightIrradiance( const in HemisphereLight hemiLight, const in vec3 normal ) {
		float dotNL = dot( normal, hemiLight.direction );
		float hemiDiffuseWeight = 0.5 * dotNL + 0.5;
		vec3 irradiance = mix( hemiLight.groundColor, hemiLight.skyColor, hemiDiffuseWeight );
		return irradiance;
	}
#endif
#include <lightprobes_pars_fragment>`,iS=`#ifdef USE_ENVMAP
	vec3 getIBLIrradiance( const in vec3 normal ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 worldNormal = transformNormalByInverseViewMatrix( normal, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * worldNormal, ENVMAP_MAX_LOD );
			return PI * envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	vec3 getIBLRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
		#ifdef ENVMAP_TYPE_PMREM
			vec3 reflectVec = reflect( - viewDir, normal );
			reflectVec = normalize( mix( reflectVec, normal, pow4( roughness ) ) );
			reflectVec = transformDirectionByInverseViewMatrix( reflectVec, viewMatrix );
			vec4 envMapColor = textureLod( envMap, envMapRotation * reflectVec, roughnessToMip( roughness ) );
			return envMapColor.rgb * envMapIntensity;
		#else
			return vec3( 0.0 );
		#endif
	}
	#ifdef USE_RETROREFLECTION
		vec3 getIBLRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 retroVec = normalize( mix( viewDir, normal, pow4( roughness ) ) );
				retroVec = transformDirectionByInverseViewMatrix( retroVec, viewMatrix );
				vec4 envMapColor = textureLod( envMap, envMapRotation * retroVec, roughnessToMip( roughness ) );
				return envMapColor.rgb * envMapIntensity;
			#else
				return vec3( 0.0 );
			#endif
		}
	#endif
	#ifdef USE_ANISOTROPY
		vec3 getIBLAnisotropyRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
			#ifdef ENVMAP_TYPE_PMREM
				vec3 bentNormal = cross( bitangent, viewDir );
				bentNormal = normalize( cross( bentNormal, bitangent ) );
				bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
				return getIBLRadiance( viewDir, bentNormal, roughness );
			#else
				return vec3( 0.0 );
			#endif
		}
		#ifdef USE_RETROREFLECTION
			vec3 getIBLAnisotropyRetroRadiance( const in vec3 viewDir, const in vec3 normal, const in float roughness, const in vec3 bitangent, const in float anisotropy ) {
				#ifdef ENVMAP_TYPE_PMREM
					vec3 bentNormal = cross( bitangent, viewDir );
					bentNormal = normalize( cross( bentNormal, bitangent ) );
					bentNormal = normalize( mix( bentNormal, normal, pow2( pow2( 1.0 - anisotropy * ( 1.0 - roughness ) ) ) ) );
					return getIBLRetroRadiance( viewDir, bentNormal, roughness );
				#else
					return vec3( 0.0 );
				#endif
			}
		#endif
	#endif
#endif`,sS=`ToonMaterial material;
material.diffuseColor = diffuseColor.rgb;`,rS=`varying vec3 vViewPosition;
struct ToonMaterial {
	vec3 diffuseColor;
};
void RE_Direct_Toon( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 irradiance = getGradientIrradiance( geometryNormal, directLight.direction ) * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
void RE_IndirectDiffuse_Toon( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in ToonMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_Toon
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Toon`,oS=`BlinnPhongMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.specularColor = specular;
material.specularShininess = shininess;
material.specularStrength = specularStrength;`,aS=`varying vec3 vViewPosition;
struct BlinnPhongMaterial {
	vec3 diffuseColor;
	vec3 specularColor;
	float specularShininess;
	float specularStrength;
};
void RE_Direct_BlinnPhong( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	reflectedLight.directDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
	reflectedLight.directSpecular += irradiance * BRDF_BlinnPhong( directLight.direction, geometryViewDir, geometryNormal, material.specularColor, material.specularShininess ) * material.specularStrength;
}
void RE_IndirectDiffuse_BlinnPhong( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in BlinnPhongMaterial material, inout ReflectedLight reflectedLight ) {
	reflectedLight.indirectDiffuse += irradiance * BRDF_Lambert( material.diffuseColor );
}
#define RE_Direct				RE_Direct_BlinnPhong
#define RE_IndirectDiffuse		RE_IndirectDiffuse_BlinnPhong`,lS=`PhysicalMaterial material;
material.diffuseColor = diffuseColor.rgb;
material.diffuseContribution = diffuseColor.rgb * ( 1.0 - metalnessFactor );
material.metalness = metalnessFactor;
vec3 dxy = max( abs( dFdx( nonPerturbedNormal ) ), abs( dFdy( nonPerturbedNormal ) ) );
float geometryRoughness = max( max( dxy.x, dxy.y ), dxy.z );
material.roughness = max( roughnessFactor, 0.045 );
material.roughness += geometryRoughness;
material.roughness = min( material.roughness, 1.0 );
#ifdef USE_DIFFUSE_ROUGHNESS
	float diffuseRoughnessFactor = diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		diffuseRoughnessFactor *= texture2D( diffuseRoughnessMap, vDiffuseRoughnessMapUv ).r;
	#endif
	material.diffuseRoughness = saturate( diffuseRoughnessFactor );
#endif
#ifdef IOR
	material.ior = ior;
	#ifdef USE_SPECULAR
		float specularIntensityFactor = specularIntensity;
		vec3 specularColorFactor = specularColor;
		#ifdef USE_SPECULAR_COLORMAP
			specularColorFactor *= texture2D( specularColorMap, vSpecularColorMapUv ).rgb;
		#endif
		#ifdef USE_SPECULAR_INTENSITYMAP
			specularIntensityFactor *= texture2D( specularIntensityMap, vSpecularIntensityMapUv ).a;
		#endif
		material.specularF90 = mix( specularIntensityFactor, 1.0, metalnessFactor );
	#else
		float specularIntensityFactor = 1.0;
		vec3 specularColorFactor = vec3( 1.0 );
		material.specularF90 = 1.0;
	#endif
	material.specularColor = min( pow2( ( material.ior - 1.0 ) / ( material.ior + 1.0 ) ) * specularColorFactor, vec3( 1.0 ) ) * specularIntensityFactor;
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
#else
	material.specularColor = vec3( 0.04 );
	material.specularColorBlended = mix( material.specularColor, diffuseColor.rgb, metalnessFactor );
	material.specularF90 = 1.0;
#endif
#ifdef USE_CLEARCOAT
	material.clearcoat = clearcoat;
	material.clearcoatRoughness = clearcoatRoughness;
	material.clearcoatF0 = vec3( 0.04 );
	material.clearcoatF90 = 1.0;
	#ifdef USE_CLEARCOATMAP
		material.clearcoat *= texture2D( clearcoatMap, vClearcoatMapUv ).x;
	#endif
	#ifdef USE_CLEARCOAT_ROUGHNESSMAP
		material.clearcoatRoughness *= texture2D( clearcoatRoughnessMap, vClearcoatRoughnessMapUv ).y;
	#endif
	material.clearcoat = saturate( material.clearcoat );	material.clearcoatRoughness = max( material.clearcoatRoughness, 0.045 );
	material.clearcoatRoughness += geometryRoughness;
	material.clearcoatRoughness = min( material.clearcoatRoughness, 1.0 );
#endif
#ifdef USE_DISPERSION
	material.dispersion = dispersion;
#endif
#ifdef USE_RETROREFLECTION
	material.retroreflectivity = retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	material.iridescence = iridescence;
	material.iridescenceIOR = iridescenceIOR;
	#ifdef USE_IRIDESCENCEMAP
		material.iridescence *= texture2D( iridescenceMap, vIridescenceMapUv ).r;
	#endif
	#ifdef USE_IRIDESCENCE_THICKNESSMAP
		material.iridescenceThickness = (iridescenceThicknessMaximum - iridescenceThicknessMinimum) * texture2D( iridescenceThicknessMap, vIridescenceThicknessMapUv ).g + iridescenceThicknessMinimum;
	#else
		material.iridescenceThickness = iridescenceThicknessMaximum;
	#endif
#endif
#ifdef USE_SHEEN
	material.sheenColor = sheenColor;
	#ifdef USE_SHEEN_COLORMAP
		material.sheenColor *= texture2D( sheenColorMap, vSheenColorMapUv ).rgb;
	#endif
	material.sheenRoughness = clamp( sheenRoughness, 0.0001, 1.0 );
	#ifdef USE_SHEEN_ROUGHNESSMAP
		material.sheenRoughness *= texture2D( sheenRoughnessMap, vSheenRoughnessMapUv ).a;
	#endif
#endif
#ifdef USE_ANISOTROPY
	#ifdef USE_ANISOTROPYMAP
		mat2 anisotropyMat = mat2( anisotropyVector.x, anisotropyVector.y, - anisotropyVector.y, anisotropyVector.x );
		vec3 anisotropyPolar = texture2D( anisotropyMap, vAnisotropyMapUv ).rgb;
		vec2 anisotropyV = anisotropyMat * normalize( 2.0 * anisotropyPolar.rg - vec2( 1.0 ) ) * anisotropyPolar.b;
	#else
		vec2 anisotropyV = anisotropyVector;
	#endif
	material.anisotropy = length( anisotropyV );
	if( material.anisotropy == 0.0 ) {
		anisotropyV = vec2( 1.0, 0.0 );
	} else {
		anisotropyV /= material.anisotropy;
		material.anisotropy = saturate( material.anisotropy );
	}
	material.alphaT = mix( pow2( material.roughness ), 1.0, pow2( material.anisotropy ) );
	material.anisotropyT = tbn[ 0 ] * anisotropyV.x + tbn[ 1 ] * anisotropyV.y;
	material.anisotropyB = tbn[ 1 ] * anisotropyV.x - tbn[ 0 ] * anisotropyV.y;
#endif`,cS=`uniform sampler2D dfgLUT;
struct PhysicalMaterial {
	vec3 diffuseColor;
	vec3 diffuseContribution;
	vec3 specularColor;
	vec3 specularColorBlended;
	float roughness;
	float metalness;
	float specularF90;
	float dispersion;
	vec2 dfg;
	vec3 multiScatteringCompensation;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float diffuseRoughness;
	#endif
	#ifdef USE_RETROREFLECTION
		float retroreflectivity;
	#endif
	#ifdef USE_CLEARCOAT
		float clearcoat;
		float clearcoatRoughness;
		vec3 clearcoatF0;
		float clearcoatF90;
	#endif
	#ifdef USE_IRIDESCENCE
		float iridescence;
		float iridescenceIOR;
		float iridescenceThickness;
		vec3 iridescenceFresnel;
		vec3 iridescenceF0Dielectric;
		vec3 iridescenceF0Metallic;
	#endif
	#ifdef USE_SHEEN
		vec3 sheenColor;
		float sheenRoughness;
	#endif
	#ifdef IOR
		float ior;
	#endif
	#ifdef USE_TRANSMISSION
		float transmission;
		float transmissionAlpha;
		float thickness;
		float attenuationDistance;
		vec3 attenuationColor;
	#endif
	#ifdef USE_ANISOTROPY
		float anisotropy;
		float alphaT;
		vec3 anisotropyT;
		vec3 anisotropyB;
	#endif
};
vec3 clearcoatSpecularDirect = vec3( 0.0 );
vec3 clearcoatSpecularIndirect = vec3( 0.0 );
vec3 sheenSpecularDirect = vec3( 0.0 );
vec3 sheenSpecularIndirect = vec3(0.0 );
vec3 Schlick_to_F0( const in vec3 f, const in float f90, const in float dotVH ) {
    float x = clamp( 1.0 - dotVH, 0.0, 1.0 );
    float x2 = x * x;
    float x5 = clamp( x * x2 * x2, 0.0, 0.9999 );
    return ( f - vec3( f90 ) * x5 ) / ( 1.0 - x5 );
}
#ifdef USE_DIFFUSE_ROUGHNESS
	const float EON_EPSILON = 1e-7;
	float FON_DirectionalAlbedo( const in float mu, const in float roughness, const in float A ) {
		float muComp = 1.0 - mu;
		float gOverPi = muComp * ( 0.0571085289 + muComp * ( 0.491881867 + muComp * ( - 0.332181442 + muComp * 0.0714429953 ) ) );
		return A * ( 1.0 + roughness * gOverPi );
	}
	vec3 BRDF_EON( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in vec3 diffuseColor, const in float roughness ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return BRDF_Lambert( rho );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float s = dot( lightDir, viewDir ) - dotNL * dotNV;
		float sOverT = ( s > 0.0 ) ? s / max( max( dotNL, dotNV ), EON_EPSILON ) : s;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		vec3 singleScatter = rho * RECIPROCAL_PI * A * ( 1.0 + roughness * sOverT );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		float albedoV = FON_DirectionalAlbedo( dotNV, roughness, A );
		float albedoL = FON_DirectionalAlbedo( dotNL, roughness, A );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		vec3 multiScatter = rhoMultiScatter * RECIPROCAL_PI
			* max( EON_EPSILON, 1.0 - albedoV )
			* max( EON_EPSILON, 1.0 - albedoL )
			/ max( EON_EPSILON, 1.0 - averageAlbedo );
		return singleScatter + multiScatter;
	}
	vec3 EON_DirectionalAlbedo( const in vec3 diffuseColor, const in float roughness, const in float dotNV ) {
		vec3 rho = saturate( diffuseColor );
		if ( roughness <= EON_EPSILON ) return rho;
		float A = 1.0 / ( 1.0 + ( 0.5 - 2.0 / ( 3.0 * PI ) ) * roughness );
		float directionalAlbedo = FON_DirectionalAlbedo( dotNV, roughness, A );
		float averageAlbedo = A * ( 1.0 + ( 2.0 / 3.0 - 28.0 / ( 15.0 * PI ) ) * roughness );
		vec3 rhoMultiScatter = rho * rho * averageAlbedo / max( vec3( EON_EPSILON ), vec3( 1.0 ) - rho * ( 1.0 - averageAlbedo ) );
		return rho * directionalAlbedo + rhoMultiScatter * ( 1.0 - directionalAlbedo );
	}
#endif
float V_GGX_SmithCorrelated( const in float alpha, const in float dotNL, const in float dotNV ) {
	float a2 = pow2( alpha );
	float gv = dotNL * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNV ) );
	float gl = dotNV * sqrt( a2 + ( 1.0 - a2 ) * pow2( dotNL ) );
	return 0.5 / max( gv + gl, EPSILON );
}
float D_GGX( const in float alpha, const in float dotNH ) {
	float a2 = pow2( alpha );
	float denom = pow2( dotNH ) * ( a2 - 1.0 ) + 1.0;
	return RECIPROCAL_PI * a2 / pow2( denom );
}
#ifdef USE_ANISOTROPY
	float V_GGX_SmithCorrelated_Anisotropic( const in float alphaT, const in float alphaB, const in float dotTV, const in float dotBV, const in float dotTL, const in float dotBL, const in float dotNV, const in float dotNL ) {
		float gv = dotNL * length( vec3( alphaT * dotTV, alphaB * dotBV, dotNV ) );
		float gl = dotNV * length( vec3( alphaT * dotTL, alphaB * dotBL, dotNL ) );
		return 0.5 / max( gv + gl, EPSILON );
	}
	float D_GGX_Anisotropic( const in float alphaT, const in float alphaB, const in float dotNH, const in float dotTH, const in float dotBH ) {
		float a2 = alphaT * alphaB;
		highp vec3 v = vec3( alphaB * dotTH, alphaT * dotBH, a2 * dotNH );
		highp float v2 = dot( v, v );
		float w2 = a2 / v2;
		return RECIPROCAL_PI * a2 * pow2 ( w2 );
	}
#endif
#ifdef USE_CLEARCOAT
	vec3 BRDF_GGX_Clearcoat( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material) {
		vec3 f0 = material.clearcoatF0;
		float f90 = material.clearcoatF90;
		float roughness = max( material.clearcoatRoughness, 0.045 );
		float alpha = pow2( roughness );
		vec3 halfDir = normalize( lightDir + viewDir );
		float dotNL = saturate( dot( normal, lightDir ) );
		float dotNV = saturate( dot( normal, viewDir ) );
		float dotNH = saturate( dot( normal, halfDir ) );
		float dotVH = saturate( dot( viewDir, halfDir ) );
		vec3 F = F_Schlick( f0, f90, dotVH );
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
		return F * ( V * D );
	}
#endif
vec3 BRDF_GGX( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, const in PhysicalMaterial material ) {
	vec3 f0 = material.specularColorBlended;
	float f90 = material.specularF90;
	float roughness = max( material.roughness, 0.045 );
	float alpha = pow2( roughness );
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float dotVH = saturate( dot( viewDir, halfDir ) );
	vec3 F = F_Schlick( f0, f90, dotVH );
	#ifdef USE_IRIDESCENCE
		F = mix( F, material.iridescenceFresnel, material.iridescence );
	#endif
	#ifdef USE_ANISOTROPY
		float dotTL = dot( material.anisotropyT, lightDir );
		float dotTV = dot( material.anisotropyT, viewDir );
		float dotTH = dot( material.anisotropyT, halfDir );
		float dotBL = dot( material.anisotropyB, lightDir );
		float dotBV = dot( material.anisotropyB, viewDir );
		float dotBH = dot( material.anisotropyB, halfDir );
		float alphaT = max( material.alphaT, alpha );
		float V = V_GGX_SmithCorrelated_Anisotropic( alphaT, alpha, dotTV, dotBV, dotTL, dotBL, dotNV, dotNL );
		float D = D_GGX_Anisotropic( alphaT, alpha, dotNH, dotTH, dotBH );
	#else
		float V = V_GGX_SmithCorrelated( alpha, dotNL, dotNV );
		float D = D_GGX( alpha, dotNH );
	#endif
	return F * ( V * D );
}
vec2 LTC_Uv( const in vec3 N, const in vec3 V, const in float roughness ) {
	const float LUT_SIZE = 64.0;
	const float LUT_SCALE = ( LUT_SIZE - 1.0 ) / LUT_SIZE;
	const float LUT_BIAS = 0.5 / LUT_SIZE;
	float dotNV = saturate( dot( N, V ) );
	vec2 uv = vec2( roughness, sqrt( 1.0 - dotNV ) );
	uv = uv * LUT_SCALE + LUT_BIAS;
	return uv;
}
float LTC_ClippedSphereFormFactor( const in vec3 f ) {
	float l = length( f );
	return max( ( l * l + f.z ) / ( l + 1.0 ), 0.0 );
}
vec3 LTC_EdgeVectorFormFactor( const in vec3 v1, const in vec3 v2 ) {
	float x = dot( v1, v2 );
	float y = abs( x );
	float a = 0.8543985 + ( 0.4965155 + 0.0145206 * y ) * y;
	float b = 3.4175940 + ( 4.1616724 + y ) * y;
	float v = a / b;
	float theta_sintheta = ( x > 0.0 ) ? v : 0.5 * inversesqrt( max( 1.0 - x * x, 1e-7 ) ) - v;
	return cross( v1, v2 ) * theta_sintheta;
}
vec3 LTC_Evaluate( const in vec3 N, const in vec3 V, const in vec3 P, const in mat3 mInv, const in vec3 rectCoords[ 4 ] ) {
	vec3 v1 = rectCoords[ 1 ] - rectCoords[ 0 ];
	vec3 v2 = rectCoords[ 3 ] - rectCoords[ 0 ];
	vec3 lightNormal = cross( v1, v2 );
	if( dot( lightNormal, P - rectCoords[ 0 ] ) < 0.0 ) return vec3( 0.0 );
	vec3 T1, T2;
	T1 = normalize( V - N * dot( V, N ) );
	T2 = - cross( N, T1 );
	mat3 mat = mInv * transpose( mat3( T1, T2, N ) );
	vec3 coords[ 4 ];
	coords[ 0 ] = mat * ( rectCoords[ 0 ] - P );
	coords[ 1 ] = mat * ( rectCoords[ 1 ] - P );
	coords[ 2 ] = mat * ( rectCoords[ 2 ] - P );
	coords[ 3 ] = mat * ( rectCoords[ 3 ] - P );
	coords[ 0 ] = normalize( coords[ 0 ] );
	coords[ 1 ] = normalize( coords[ 1 ] );
	coords[ 2 ] = normalize( coords[ 2 ] );
	coords[ 3 ] = normalize( coords[ 3 ] );
	vec3 vectorFormFactor = vec3( 0.0 );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 0 ], coords[ 1 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 1 ], coords[ 2 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 2 ], coords[ 3 ] );
	vectorFormFactor += LTC_EdgeVectorFormFactor( coords[ 3 ], coords[ 0 ] );
	float result = LTC_ClippedSphereFormFactor( vectorFormFactor );
	return vec3( result );
}
#if defined( USE_SHEEN )
float D_Charlie( float roughness, float dotNH ) {
	float alpha = pow2( roughness );
	float invAlpha = 1.0 / alpha;
	float cos2h = dotNH * dotNH;
	float sin2h = max( 1.0 - cos2h, 0.0078125 );
	return ( 2.0 + invAlpha ) * pow( sin2h, invAlpha * 0.5 ) / ( 2.0 * PI );
}
float V_Neubelt( float dotNV, float dotNL ) {
	return saturate( 1.0 / ( 4.0 * ( dotNL + dotNV - dotNL * dotNV ) ) );
}
vec3 BRDF_Sheen( const in vec3 lightDir, const in vec3 viewDir, const in vec3 normal, vec3 sheenColor, const in float sheenRoughness ) {
	vec3 halfDir = normalize( lightDir + viewDir );
	float dotNL = saturate( dot( normal, lightDir ) );
	float dotNV = saturate( dot( normal, viewDir ) );
	float dotNH = saturate( dot( normal, halfDir ) );
	float D = D_Charlie( sheenRoughness, dotNH );
	float V = V_Neubelt( dotNV, dotNL );
	return sheenColor * ( D * V );
}
#endif
float IBLSheenBRDF( const in vec3 normal, const in vec3 viewDir, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	float r2 = roughness * roughness;
	float rInv = 1.0 / ( roughness + 0.1 );
	float a = -1.9362 + 1.0678 * roughness + 0.4573 * r2 - 0.8469 * rInv;
	float b = -0.6014 + 0.5538 * roughness - 0.4670 * r2 - 0.1255 * rInv;
	float DG = exp( a * dotNV + b );
	return saturate( DG );
}
vec3 EnvironmentBRDF( const in vec3 normal, const in vec3 viewDir, const in vec3 specularColor, const in float specularF90, const in float roughness ) {
	float dotNV = saturate( dot( normal, viewDir ) );
	vec2 fab = texture2D( dfgLUT, vec2( roughness, dotNV ) ).rg;
	return specularColor * fab.x + specularF90 * fab.y;
}
#ifdef USE_IRIDESCENCE
void computeMultiscatteringIridescence( const in vec2 fab, const in vec3 specularColor, const in float specularF90, const in float iridescence, const in vec3 iridescenceF0, inout vec3 singleScatter, inout vec3 multiScatter ) {
#else
void computeMultiscattering( const in vec2 fab, const in vec3 specularColor, const in float specularF90, inout vec3 singleScatter, inout vec3 multiScatter ) {
#endif
	#ifdef USE_IRIDESCENCE
		vec3 Fr = mix( specularColor, iridescenceF0, iridescence );
	#else
		vec3 Fr = specularColor;
	#endif
	vec3 FssEss = Fr * fab.x + specularF90 * fab.y;
	float Ess = fab.x + fab.y;
	float Ems = 1.0 - Ess;
	vec3 Favg = Fr + ( 1.0 - Fr ) * 0.047619;	vec3 Fms = FssEss * Favg / ( 1.0 - Ems * Favg );
	singleScatter += FssEss;
	multiScatter += Fms * Ems;
}
#if NUM_RECT_AREA_LIGHTS > 0
	void RE_Direct_RectArea_Physical( const in RectAreaLight rectAreaLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
		vec3 normal = geometryNormal;
		vec3 viewDir = geometryViewDir;
		vec3 position = geometryPosition;
		vec3 lightPos = rectAreaLight.position;
		vec3 halfWidth = rectAreaLight.halfWidth;
		vec3 halfHeight = rectAreaLight.halfHeight;
		vec3 lightColor = rectAreaLight.color;
		float roughness = material.roughness;
		vec3 rectCoords[ 4 ];
		rectCoords[ 0 ] = lightPos + halfWidth - halfHeight;		rectCoords[ 1 ] = lightPos - halfWidth - halfHeight;
		rectCoords[ 2 ] = lightPos - halfWidth + halfHeight;
		rectCoords[ 3 ] = lightPos + halfWidth + halfHeight;
		vec2 uv = LTC_Uv( normal, viewDir, roughness );
		vec4 t1 = texture2D( ltc_1, uv );
		vec4 t2 = texture2D( ltc_2, uv );
		mat3 mInv = mat3(
			vec3( t1.x, 0, t1.y ),
			vec3(    0, 1,    0 ),
			vec3( t1.z, 0, t1.w )
		);
		vec3 fresnel = ( material.specularColorBlended * t2.x + ( material.specularF90 - material.specularColorBlended ) * t2.y );
		reflectedLight.directSpecular += lightColor * fresnel * LTC_Evaluate( normal, viewDir, position, mInv, rectCoords );
		reflectedLight.directDiffuse += lightColor * material.diffuseContribution * LTC_Evaluate( normal, viewDir, position, mat3( 1.0 ), rectCoords );
		#ifdef USE_CLEARCOAT
			vec3 Ncc = geometryClearcoatNormal;
			vec2 uvClearcoat = LTC_Uv( Ncc, viewDir, material.clearcoatRoughness );
			vec4 t1Clearcoat = texture2D( ltc_1, uvClearcoat );
			vec4 t2Clearcoat = texture2D( ltc_2, uvClearcoat );
			mat3 mInvClearcoat = mat3(
				vec3( t1Clearcoat.x, 0, t1Clearcoat.y ),
				vec3(             0, 1,             0 ),
				vec3( t1Clearcoat.z, 0, t1Clearcoat.w )
			);
			vec3 fresnelClearcoat = material.clearcoatF0 * t2Clearcoat.x + ( material.clearcoatF90 - material.clearcoatF0 ) * t2Clearcoat.y;
			clearcoatSpecularDirect += lightColor * fresnelClearcoat * LTC_Evaluate( Ncc, viewDir, position, mInvClearcoat, rectCoords );
		#endif
	}
#endif
void RE_Direct_Physical( const in IncidentLight directLight, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	float dotNL = saturate( dot( geometryNormal, directLight.direction ) );
	vec3 irradiance = dotNL * directLight.color;
	#ifdef USE_CLEARCOAT
		float dotNLcc = saturate( dot( geometryClearcoatNormal, directLight.direction ) );
		vec3 ccIrradiance = dotNLcc * directLight.color;
		clearcoatSpecularDirect += ccIrradiance * BRDF_GGX_Clearcoat( directLight.direction, geometryViewDir, geometryClearcoatNormal, material );
	#endif
	#ifdef USE_SHEEN
 
 		sheenSpecularDirect += irradiance * BRDF_Sheen( directLight.direction, geometryViewDir, geometryNormal, material.sheenColor, material.sheenRoughness );
 
 		float sheenAlbedoV = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
 		float sheenAlbedoL = IBLSheenBRDF( geometryNormal, directLight.direction, material.sheenRoughness );
 
 		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * max( sheenAlbedoV, sheenAlbedoL );
 
 		irradiance *= sheenEnergyComp;
 
 	#endif
	vec3 specularBRDF = BRDF_GGX( directLight.direction, geometryViewDir, geometryNormal, material );
	#ifdef USE_RETROREFLECTION
		vec3 retroViewDir = reflect( - geometryViewDir, geometryNormal );
		vec3 retroSpecularBRDF = BRDF_GGX( directLight.direction, retroViewDir, geometryNormal, material );
		specularBRDF = mix( specularBRDF, retroSpecularBRDF, saturate( material.retroreflectivity ) );
	#endif
	reflectedLight.directSpecular += irradiance * specularBRDF * material.multiScatteringCompensation;
	vec3 halfDir = normalize( directLight.direction + geometryViewDir );
	float dotVH = saturate( dot( geometryViewDir, halfDir ) );
	vec3 F = F_Schlick( material.specularColor, material.specularF90, dotVH );
	#ifdef USE_RETROREFLECTION
		vec3 retroHalfDir = normalize( directLight.direction + retroViewDir );
		float dotRetroVH = saturate( dot( retroViewDir, retroHalfDir ) );
		vec3 retroF = F_Schlick( material.specularColor, material.specularF90, dotRetroVH );
		F = mix( F, retroF, saturate( material.retroreflectivity ) );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		vec3 diffuseBRDF = BRDF_EON( directLight.direction, geometryViewDir, geometryNormal, material.diffuseColor, material.diffuseRoughness ) * ( 1.0 - material.metalness );
	#else
		vec3 diffuseBRDF = BRDF_Lambert( material.diffuseContribution );
	#endif
	reflectedLight.directDiffuse += irradiance * diffuseBRDF * ( 1.0 - F );
}
void RE_IndirectDiffuse_Physical( const in vec3 irradiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight ) {
	vec3 singleScattering = vec3( 0.0 );
	vec3 multiScattering = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScattering, multiScattering );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScattering, multiScattering );
	#endif
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuseAlbedo = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness );
		vec3 diffuse = irradiance * RECIPROCAL_PI * diffuseAlbedo * ( 1.0 - singleScattering - multiScattering );
	#else
		vec3 diffuse = irradiance * BRDF_Lambert( material.diffuseContribution ) * ( 1.0 - singleScattering - multiScattering );
	#endif
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		sheenSpecularIndirect += irradiance * material.sheenColor * sheenAlbedo * RECIPROCAL_PI;
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		diffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectDiffuse += diffuse;
}
void RE_IndirectSpecular_Physical( const in vec3 radiance, const in vec3 irradiance, const in vec3 clearcoatRadiance, const in vec3 geometryPosition, const in vec3 geometryNormal, const in vec3 geometryViewDir, const in vec3 geometryClearcoatNormal, const in PhysicalMaterial material, inout ReflectedLight reflectedLight) {
	#ifdef USE_CLEARCOAT
		clearcoatSpecularIndirect += clearcoatRadiance * EnvironmentBRDF( geometryClearcoatNormal, geometryViewDir, material.clearcoatF0, material.clearcoatF90, material.clearcoatRoughness );
	#endif
	#ifdef USE_SHEEN
		sheenSpecularIndirect += irradiance * material.sheenColor * IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness ) * RECIPROCAL_PI;
 	#endif
	vec3 singleScatteringDielectric = vec3( 0.0 );
	vec3 multiScatteringDielectric = vec3( 0.0 );
	vec3 singleScatteringMetallic = vec3( 0.0 );
	vec3 multiScatteringMetallic = vec3( 0.0 );
	#ifdef USE_IRIDESCENCE
		computeMultiscatteringIridescence( material.dfg, material.specularColor, material.specularF90, material.iridescence, material.iridescenceF0Dielectric, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscatteringIridescence( material.dfg, material.diffuseColor, material.specularF90, material.iridescence, material.iridescenceF0Metallic, singleScatteringMetallic, multiScatteringMetallic );
	#else
		computeMultiscattering( material.dfg, material.specularColor, material.specularF90, singleScatteringDielectric, multiScatteringDielectric );
		computeMultiscattering( material.dfg, material.diffuseColor, material.specularF90, singleScatteringMetallic, multiScatteringMetallic );
	#endif
	vec3 singleScattering = mix( singleScatteringDielectric, singleScatteringMetallic, material.metalness );
	vec3 multiScattering = mix( multiScatteringDielectric, multiScatteringMetallic, material.metalness );
	vec3 totalScatteringDielectric = singleScatteringDielectric + multiScatteringDielectric;
	#ifdef USE_DIFFUSE_ROUGHNESS
		float dotNV = saturate( dot( geometryNormal, geometryViewDir ) );
		vec3 diffuse = EON_DirectionalAlbedo( material.diffuseColor, material.diffuseRoughness, dotNV ) * ( 1.0 - material.metalness ) * ( 1.0 - totalScatteringDielectric );
	#else
		vec3 diffuse = material.diffuseContribution * ( 1.0 - totalScatteringDielectric );
	#endif
	vec3 cosineWeightedIrradiance = irradiance * RECIPROCAL_PI;
	vec3 indirectSpecular = radiance * singleScattering;
	indirectSpecular += multiScattering * cosineWeightedIrradiance;
	vec3 indirectDiffuse = diffuse * cosineWeightedIrradiance;
	#ifdef USE_SHEEN
		float sheenAlbedo = IBLSheenBRDF( geometryNormal, geometryViewDir, material.sheenRoughness );
		float sheenEnergyComp = 1.0 - max3( material.sheenColor ) * sheenAlbedo;
		indirectSpecular *= sheenEnergyComp;
		indirectDiffuse *= sheenEnergyComp;
	#endif
	reflectedLight.indirectSpecular += indirectSpecular;
	reflectedLight.indirectDiffuse += indirectDiffuse;
}
#define RE_Direct				RE_Direct_Physical
#define RE_Direct_RectArea		RE_Direct_RectArea_Physical
#define RE_IndirectDiffuse		RE_IndirectDiffuse_Physical
#define RE_IndirectSpecular		RE_IndirectSpecular_Physical
float computeSpecularOcclusion( const in float dotNV, const in float ambientOcclusion, const in float roughness ) {
	return saturate( pow( dotNV + ambientOcclusion, exp2( - 16.0 * roughness - 1.0 ) ) - 1.0 + ambientOcclusion );
}`,hS=`
vec3 geometryPosition = - vViewPosition;
vec3 geometryNormal = normal;
vec3 geometryViewDir = ( isOrthographic ) ? vec3( 0, 0, 1 ) : normalize( vViewPosition );
vec3 geometryClearcoatNormal = vec3( 0.0 );
#ifdef USE_CLEARCOAT
	geometryClearcoatNormal = clearcoatNormal;
#endif
#ifdef USE_IRIDESCENCE
	float dotNVi = saturate( dot( normal, geometryViewDir ) );
	if ( material.iridescenceThickness == 0.0 ) {
		material.iridescence = 0.0;
	} else {
		material.iridescence = saturate( material.iridescence );
	}
	if ( material.iridescence > 0.0 ) {
		vec3 iridescenceFresnelDielectric = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.specularColor );
		vec3 iridescenceFresnelMetallic = evalIridescence( 1.0, material.iridescenceIOR, dotNVi, material.iridescenceThickness, material.diffuseColor );
		material.iridescenceFresnel = mix( iridescenceFresnelDielectric, iridescenceFresnelMetallic, material.metalness );
		material.iridescenceF0Dielectric = Schlick_to_F0( iridescenceFresnelDielectric, 1.0, dotNVi );
		material.iridescenceF0Metallic = Schlick_to_F0( iridescenceFresnelMetallic, 1.0, dotNVi );
	}
#endif
#ifdef STANDARD
	float dotNVms = saturate( dot( geometryNormal, geometryViewDir ) );
	material.dfg = texture2D( dfgLUT, vec2( material.roughness, dotNVms ) ).rg;
	#if ( NUM_SUN_LIGHTS > 0 || NUM_DIR_LIGHTS > 0 || NUM_POINT_LIGHTS > 0 || NUM_SPOT_LIGHTS > 0 )
		float EssMs = material.dfg.x + material.dfg.y;
		material.multiScatteringCompensation = 1.0 + material.specularColorBlended * ( 1.0 / EssMs - 1.0 );
	#endif
#endif
IncidentLight directLight;
#if ( NUM_POINT_LIGHTS > 0 ) && defined( RE_Direct )
	PointLight pointLight;
	#if defined( USE_SHADOWMAP ) && NUM_POINT_LIGHT_SHADOWS > 0
	PointLightShadow pointLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHTS; i ++ ) {
		pointLight = pointLights[ i ];
		getPointLightInfo( pointLight, geometryPosition, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_POINT_LIGHT_SHADOWS ) && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
		pointLightShadow = pointLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getPointShadow( pointShadowMap[ i ], pointLightShadow.shadowMapSize, pointLightShadow.shadowIntensity, pointLightShadow.shadowBias, pointLightShadow.shadowRadius, vPointShadowCoord[ i ], pointLightShadow.shadowCameraNear, pointLightShadow.shadowCameraFar ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SPOT_LIGHTS > 0 ) && defined( RE_Direct )
	SpotLight spotLight;
	vec4 spotColor;
	vec3 spotLightCoord;
	bool inSpotLightMap;
	#if defined( USE_SHADOWMAP ) && NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHTS; i ++ ) {
		spotLight = spotLights[ i ];
		getSpotLightInfo( spotLight, geometryPosition, directLight );
		#if ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#define SPOT_LIGHT_MAP_INDEX UNROLLED_LOOP_INDEX
		#elif ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		#define SPOT_LIGHT_MAP_INDEX NUM_SPOT_LIGHT_MAPS
		#else
		#define SPOT_LIGHT_MAP_INDEX ( UNROLLED_LOOP_INDEX - NUM_SPOT_LIGHT_SHADOWS + NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS )
		#endif
		#if ( SPOT_LIGHT_MAP_INDEX < NUM_SPOT_LIGHT_MAPS )
			spotLightCoord = vSpotLightCoord[ i ].xyz / vSpotLightCoord[ i ].w;
			inSpotLightMap = all( lessThan( abs( spotLightCoord * 2. - 1. ), vec3( 1.0 ) ) );
			spotColor = texture2D( spotLightMap[ SPOT_LIGHT_MAP_INDEX ], spotLightCoord.xy );
			directLight.color = inSpotLightMap ? directLight.color * spotColor.rgb : directLight.color;
		#endif
		#undef SPOT_LIGHT_MAP_INDEX
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
		spotLightShadow = spotLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( spotShadowMap[ i ], spotLightShadow.shadowMapSize, spotLightShadow.shadowIntensity, spotLightShadow.shadowBias, spotLightShadow.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_SUN_LIGHTS > 0 ) && defined( RE_Direct )
	SunLight sunLight;
	#if defined( USE_SHADOWMAP ) && NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHTS; i ++ ) {
		sunLight = sunLights[ i ];
		getSunLightInfo( sunLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_SUN_LIGHT_SHADOWS )
		sunLightShadow = sunLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getSunShadow( sunShadowMap[ i ], sunLightShadow, UNROLLED_LOOP_INDEX ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_DIR_LIGHTS > 0 ) && defined( RE_Direct )
	DirectionalLight directionalLight;
	#if defined( USE_SHADOWMAP ) && NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLightShadow;
	#endif
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHTS; i ++ ) {
		directionalLight = directionalLights[ i ];
		getDirectionalLightInfo( directionalLight, directLight );
		#if defined( USE_SHADOWMAP ) && ( UNROLLED_LOOP_INDEX < NUM_DIR_LIGHT_SHADOWS )
		directionalLightShadow = directionalLightShadows[ i ];
		directLight.color *= ( directLight.visible && receiveShadow ) ? getShadow( directionalShadowMap[ i ], directionalLightShadow.shadowMapSize, directionalLightShadow.shadowIntensity, directionalLightShadow.shadowBias, directionalLightShadow.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
		#endif
		RE_Direct( directLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if ( NUM_RECT_AREA_LIGHTS > 0 ) && defined( RE_Direct_RectArea )
	RectAreaLight rectAreaLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_RECT_AREA_LIGHTS; i ++ ) {
		rectAreaLight = rectAreaLights[ i ];
		RE_Direct_RectArea( rectAreaLight, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
	}
	#pragma unroll_loop_end
#endif
#if defined( RE_IndirectDiffuse )
	vec3 iblIrradiance = vec3( 0.0 );
	vec3 irradiance = getAmbientLightIrradiance( ambientLightColor );
	#if defined( USE_LIGHT_PROBES )
		irradiance += getLightProbeIrradiance( lightProbe, geometryNormal );
	#endif
	#if ( NUM_HEMI_LIGHTS > 0 )
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_HEMI_LIGHTS; i ++ ) {
			irradiance += getHemisphereLightIrradiance( hemisphereLights[ i ], geometryNormal );
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_LIGHT_PROBE_GRIDS > 0
		vec3 probeWorldPos = ( ( vec4( geometryPosition, 1.0 ) - viewMatrix[ 3 ] ) * viewMatrix ).xyz;
		vec3 probeWorldNormal = transformNormalByInverseViewMatrix( geometryNormal, viewMatrix );
		int probeGrid = - 1;
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( isInsideLightProbeGrid( probeWorldPos, probeWorldNormal, probesMin[ i ], probesMax[ i ], probesResolution[ i ] ) ) probeGrid = UNROLLED_LOOP_INDEX;
		}
		#pragma unroll_loop_end
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_LIGHT_PROBE_GRIDS; i ++ ) {
			if ( probeGrid == UNROLLED_LOOP_INDEX ) irradiance += getLightProbeGridIrradiance( probesSH[ i ], probesMin[ i ], probesMax[ i ], probesResolution[ i ], probeWorldPos, probeWorldNormal );
		}
		#pragma unroll_loop_end
	#endif
#endif
#if defined( RE_IndirectSpecular )
	vec3 radiance = vec3( 0.0 );
	vec3 clearcoatRadiance = vec3( 0.0 );
#endif`,uS=`#if defined( RE_IndirectDiffuse )
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		vec3 lightMapIrradiance = lightMapTexel.rgb * lightMapIntensity;
		irradiance += lightMapIrradiance;
	#endif
	#if defined( USE_ENVMAP ) && defined( ENVMAP_TYPE_PMREM )
		#if defined( STANDARD ) || defined( LAMBERT ) || defined( PHONG )
			iblIrradiance += getIBLIrradiance( geometryNormal );
		#endif
	#endif
#endif
#if defined( USE_ENVMAP ) && defined( RE_IndirectSpecular )
	#ifdef USE_ANISOTROPY
		vec3 iblRadiance = getIBLAnisotropyRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
	#else
		vec3 iblRadiance = getIBLRadiance( geometryViewDir, geometryNormal, material.roughness );
	#endif
	#ifdef USE_RETROREFLECTION
		#ifdef USE_ANISOTROPY
			vec3 retroIBLRadiance = getIBLAnisotropyRetroRadiance( geometryViewDir, geometryNormal, material.roughness, material.anisotropyB, material.anisotropy );
		#else
			vec3 retroIBLRadiance = getIBLRetroRadiance( geometryViewDir, geometryNormal, material.roughness );
		#endif
		iblRadiance = mix( iblRadiance, retroIBLRadiance, saturate( material.retroreflectivity ) );
	#endif
	radiance += iblRadiance;
	#ifdef USE_CLEARCOAT
		clearcoatRadiance += getIBLRadiance( geometryViewDir, geometryClearcoatNormal, material.clearcoatRoughness );
	#endif
#endif`,fS=`#if defined( RE_IndirectDiffuse )
	#if defined( LAMBERT ) || defined( PHONG )
		irradiance += iblIrradiance;
	#endif
	RE_IndirectDiffuse( irradiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif
#if defined( RE_IndirectSpecular )
	RE_IndirectSpecular( radiance, iblIrradiance, clearcoatRadiance, geometryPosition, geometryNormal, geometryViewDir, geometryClearcoatNormal, material, reflectedLight );
#endif`,dS=`#if NUM_LIGHT_PROBE_GRIDS > 0
uniform highp sampler3D probesSH[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMin[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesMax[ NUM_LIGHT_PROBE_GRIDS ];
uniform vec3 probesResolution[ NUM_LIGHT_PROBE_GRIDS ];
bool isInsideLightProbeGrid( vec3 worldPos, vec3 worldNormal, vec3 probesMin, vec3 probesMax, vec3 probesResolution ) {
	vec3 spacing = ( probesMax - probesMin ) / probesResolution;
	vec3 samplePos = worldPos + worldNormal * spacing * 0.5;
	vec3 margin = spacing * 0.01;
	return all( greaterThanEqual( samplePos, probesMin - margin ) ) && all( lessThanEqual( samplePos, probesMax + margin ) );
}
vec3 getLightProbeGridIrradiance( highp sampler3D probesSH, vec3 probesMin, vec3 probesMax, vec3 probesResolution, vec3 worldPos, vec3 worldNormal ) {
	vec3 res = probesResolution;
	vec3 gridRange = probesMax - probesMin;
	vec3 probeSpacing = gridRange / res;
	vec3 samplePos = worldPos + worldNormal * probeSpacing * 0.5;
	vec3 uvw = clamp( ( samplePos - probesMin ) / gridRange, 0.5 / res, 1.0 - 0.5 / res );
	float nz          = res.z;
	float paddedSlices = nz + 2.0;
	float atlasDepth  = 7.0 * paddedSlices;
	float uvZBase     = uvw.z * nz + 1.0;
	vec4 s0 = texture( probesSH, vec3( uvw.xy, ( uvZBase                       ) / atlasDepth ) );
	vec4 s1 = texture( probesSH, vec3( uvw.xy, ( uvZBase +       paddedSlices   ) / atlasDepth ) );
	vec4 s2 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 2.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s3 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 3.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s4 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 4.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s5 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 5.0 * paddedSlices   ) / atlasDepth ) );
	vec4 s6 = texture( probesSH, vec3( uvw.xy, ( uvZBase + 6.0 * paddedSlices   ) / atlasDepth ) );
	vec3 c0 = s0.xyz;
	vec3 c1 = vec3( s0.w, s1.xy );
	vec3 c2 = vec3( s1.zw, s2.x );
	vec3 c3 = s2.yzw;
	vec3 c4 = s3.xyz;
	vec3 c5 = vec3( s3.w, s4.xy );
	vec3 c6 = vec3( s4.zw, s5.x );
	vec3 c7 = s5.yzw;
	vec3 c8 = s6.xyz;
	float x = worldNormal.x, y = worldNormal.y, z = worldNormal.z;
	vec3 result = c0 * 0.886227;
	result += c1 * 2.0 * 0.511664 * y;
	result += c2 * 2.0 * 0.511664 * z;
	result += c3 * 2.0 * 0.511664 * x;
	result += c4 * 2.0 * 0.429043 * x * y;
	result += c5 * 2.0 * 0.429043 * y * z;
	result += c6 * ( 0.743125 * z * z - 0.247708 );
	result += c7 * 2.0 * 0.429043 * x * z;
	result += c8 * 0.429043 * ( x * x - y * y );
	return max( result, vec3( 0.0 ) );
}
#endif`,pS=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	gl_FragDepth = vIsPerspective == 0.0 ? gl_FragCoord.z : log2( vFragDepth ) * logDepthBufFC * 0.5;
#endif`,mS=`#if defined( USE_LOGARITHMIC_DEPTH_BUFFER )
	uniform float logDepthBufFC;
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,gS=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	varying float vFragDepth;
	varying float vIsPerspective;
#endif`,yS=`#ifdef USE_LOGARITHMIC_DEPTH_BUFFER
	vFragDepth = 1.0 + gl_Position.w;
	vIsPerspective = float( isPerspectiveMatrix( projectionMatrix ) );
#endif`,_S=`#ifdef USE_MAP
	vec4 sampledDiffuseColor = texture2D( map, vMapUv );
	#ifdef DECODE_VIDEO_TEXTURE
		sampledDiffuseColor = sRGBTransferEOTF( sampledDiffuseColor );
	#endif
	diffuseColor *= sampledDiffuseColor;
#endif`,xS=`#ifdef USE_MAP
	uniform sampler2D map;
#endif`,vS=`#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
	#if defined( USE_POINTS_UV )
		vec2 uv = vUv;
	#else
		vec2 uv = ( uvTransform * vec3( gl_PointCoord.x, 1.0 - gl_PointCoord.y, 1 ) ).xy;
	#endif
#endif
#ifdef USE_MAP
	diffuseColor *= texture2D( map, uv );
#endif
#ifdef USE_ALPHAMAP
	diffuseColor.a *= texture2D( alphaMap, uv ).g;
#endif`,bS=`#if defined( USE_POINTS_UV )
	varying vec2 vUv;
#else
	#if defined( USE_MAP ) || defined( USE_ALPHAMAP )
		uniform mat3 uvTransform;
	#endif
#endif
#ifdef USE_MAP
	uniform sampler2D map;
#endif
#ifdef USE_ALPHAMAP
	uniform sampler2D alphaMap;
#endif`,MS=`float metalnessFactor = metalness;
#ifdef USE_METALNESSMAP
	vec4 texelMetalness = texture2D( metalnessMap, vMetalnessMapUv );
	metalnessFactor *= texelMetalness.b;
#endif`,SS=`#ifdef USE_METALNESSMAP
	uniform sampler2D metalnessMap;
#endif`,wS=`#ifdef USE_INSTANCING_MORPH
	float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	float morphTargetBaseInfluence = texelFetch( morphTexture, ivec2( 0, gl_InstanceID ), 0 ).r;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		morphTargetInfluences[i] =  texelFetch( morphTexture, ivec2( i + 1, gl_InstanceID ), 0 ).r;
	}
#endif`,AS=`#if defined( USE_MORPHCOLORS )
	#if defined( USE_COLOR_ALPHA )
		vColor *= morphTargetBaseInfluence;
	#elif defined( USE_COLOR )
		vColor.rgb *= morphTargetBaseInfluence;
	#endif
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		#if defined( USE_COLOR_ALPHA )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor += getMorph( gl_VertexID, i, 2 ) * morphTargetInfluences[ i ];
		#elif defined( USE_COLOR )
			if ( morphTargetInfluences[ i ] != 0.0 ) vColor.rgb += getMorph( gl_VertexID, i, 2 ).rgb * morphTargetInfluences[ i ];
		#endif
	}
#endif`,ES=`#ifdef USE_MORPHNORMALS
	objectNormal *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) objectNormal += getMorph( gl_VertexID, i, 1 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,TS=`#ifdef USE_MORPHTARGETS
	#ifndef USE_INSTANCING_MORPH
		uniform float morphTargetBaseInfluence;
		uniform float morphTargetInfluences[ MORPHTARGETS_COUNT ];
	#endif
	uniform sampler2DArray morphTargetsTexture;
	uniform ivec2 morphTargetsTextureSize;
	vec4 getMorph( const in int vertexIndex, const in int morphTargetIndex, const in int offset ) {
		int texelIndex = vertexIndex * MORPHTARGETS_TEXTURE_STRIDE + offset;
		int y = texelIndex / morphTargetsTextureSize.x;
		int x = texelIndex - y * morphTargetsTextureSize.x;
		ivec3 morphUV = ivec3( x, y, morphTargetIndex );
		return texelFetch( morphTargetsTexture, morphUV, 0 );
	}
#endif`,CS=`#ifdef USE_MORPHTARGETS
	transformed *= morphTargetBaseInfluence;
	for ( int i = 0; i < MORPHTARGETS_COUNT; i ++ ) {
		if ( morphTargetInfluences[ i ] != 0.0 ) transformed += getMorph( gl_VertexID, i, 0 ).xyz * morphTargetInfluences[ i ];
	}
#endif`,RS=`float faceDirection = gl_FrontFacing ? 1.0 : - 1.0;
#ifdef FLAT_SHADED
	vec3 fdx = dFdx( vViewPosition );
	vec3 fdy = dFdy( vViewPosition );
	vec3 normal = normalize( cross( fdx, fdy ) );
#else
	vec3 normal = normalize( vNormal );
	#ifdef DOUBLE_SIDED
		normal *= faceDirection;
	#endif
#endif
#if defined( USE_NORMALMAP_TANGENTSPACE ) || defined( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY )
	#ifdef USE_TANGENT
		mat3 tbn = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn = getTangentFrame( - vViewPosition, normal,
		#if defined( USE_NORMALMAP )
			vNormalMapUv
		#elif defined( USE_CLEARCOAT_NORMALMAP )
			vClearcoatNormalMapUv
		#else
			vUv
		#endif
		);
	#endif
	#ifdef DOUBLE_SIDED
		tbn[0] *= faceDirection;
		tbn[1] *= faceDirection;
	#endif
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	#ifdef USE_TANGENT
		mat3 tbn2 = mat3( normalize( vTangent ), normalize( vBitangent ), normal );
	#else
		mat3 tbn2 = getTangentFrame( - vViewPosition, normal, vClearcoatNormalMapUv );
	#endif
	#ifdef DOUBLE_SIDED
		tbn2[0] *= faceDirection;
		tbn2[1] *= faceDirection;
	#endif
#endif
vec3 nonPerturbedNormal = normal;`,IS=`#ifdef USE_NORMALMAP_OBJECTSPACE
	normal = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#ifdef FLIP_SIDED
		normal = - normal;
	#endif
	#ifdef DOUBLE_SIDED
		normal = normal * faceDirection;
	#endif
	normal = normalize( normalMatrix * normal );
#elif defined( USE_NORMALMAP_TANGENTSPACE )
	vec3 mapN = texture2D( normalMap, vNormalMapUv ).xyz * 2.0 - 1.0;
	#if defined( USE_PACKED_NORMALMAP )
		mapN = vec3( mapN.xy, sqrt( saturate( 1.0 - dot( mapN.xy, mapN.xy ) ) ) );
	#endif
	mapN.xy *= normalScale;
	normal = normalize( tbn * mapN );
#elif defined( USE_BUMPMAP )
	normal = perturbNormalArb( - vViewPosition, normal, dHdxy_fwd(), faceDirection );
#endif`,PS=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,LS=`#ifndef FLAT_SHADED
	varying vec3 vNormal;
	#ifdef USE_TANGENT
		varying vec3 vTangent;
		varying vec3 vBitangent;
	#endif
#endif`,DS=`#ifndef FLAT_SHADED
	vNormal = normalize( transformedNormal );
	#ifdef USE_TANGENT
		vTangent = normalize( transformedTangent );
		vBitangent = normalize( cross( vNormal, vTangent ) * tangent.w );
		#ifdef FLIP_SIDED
			vBitangent = - vBitangent;
		#endif
	#endif
#endif`,NS=`#ifdef USE_NORMALMAP
	uniform sampler2D normalMap;
	uniform vec2 normalScale;
#endif
#ifdef USE_NORMALMAP_OBJECTSPACE
	uniform mat3 normalMatrix;
#endif
#if ! defined ( USE_TANGENT ) && ( defined ( USE_NORMALMAP_TANGENTSPACE ) || defined ( USE_CLEARCOAT_NORMALMAP ) || defined( USE_ANISOTROPY ) )
	mat3 getTangentFrame( vec3 eye_pos, vec3 surf_norm, vec2 uv ) {
		vec3 q0 = dFdx( eye_pos.xyz );
		vec3 q1 = dFdy( eye_pos.xyz );
		vec2 st0 = dFdx( uv.st );
		vec2 st1 = dFdy( uv.st );
		vec3 N = surf_norm;
		vec3 q1perp = cross( q1, N );
		vec3 q0perp = cross( N, q0 );
		vec3 T = q1perp * st0.x + q0perp * st1.x;
		vec3 B = q1perp * st0.y + q0perp * st1.y;
		float det = max( dot( T, T ), dot( B, B ) );
		float scale = ( det == 0.0 ) ? 0.0 : inversesqrt( det );
		return mat3( T * scale, B * scale, N );
	}
#endif`,US=`#ifdef USE_CLEARCOAT
	vec3 clearcoatNormal = nonPerturbedNormal;
#endif`,FS=`#ifdef USE_CLEARCOAT_NORMALMAP
	vec3 clearcoatMapN = texture2D( clearcoatNormalMap, vClearcoatNormalMapUv ).xyz * 2.0 - 1.0;
	clearcoatMapN.xy *= clearcoatNormalScale;
	clearcoatNormal = normalize( tbn2 * clearcoatMapN );
#endif`,OS=`#ifdef USE_CLEARCOATMAP
	uniform sampler2D clearcoatMap;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform sampler2D clearcoatNormalMap;
	uniform vec2 clearcoatNormalScale;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform sampler2D clearcoatRoughnessMap;
#endif`,kS=`#ifdef USE_IRIDESCENCEMAP
	uniform sampler2D iridescenceMap;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform sampler2D iridescenceThicknessMap;
#endif`,BS=`#ifdef OPAQUE
diffuseColor.a = 1.0;
#endif
#ifdef USE_TRANSMISSION
diffuseColor.a *= material.transmissionAlpha;
#endif
gl_FragColor = vec4( outgoingLight, diffuseColor.a );`,zS=`vec3 packNormalToRGB( const in vec3 normal ) {
	return normalize( normal ) * 0.5 + 0.5;
}
vec3 unpackRGBToNormal( const in vec3 rgb ) {
	return 2.0 * rgb.xyz - 1.0;
}
const float PackUpscale = 256. / 255.;const float UnpackDownscale = 255. / 256.;const float ShiftRight8 = 1. / 256.;
const float Inv255 = 1. / 255.;
const vec4 PackFactors = vec4( 1.0, 256.0, 256.0 * 256.0, 256.0 * 256.0 * 256.0 );
const vec2 UnpackFactors2 = vec2( UnpackDownscale, 1.0 / PackFactors.g );
const vec3 UnpackFactors3 = vec3( UnpackDownscale / PackFactors.rg, 1.0 / PackFactors.b );
const vec4 UnpackFactors4 = vec4( UnpackDownscale / PackFactors.rgb, 1.0 / PackFactors.a );
vec4 packDepthToRGBA( const in float v ) {
	if( v <= 0.0 )
		return vec4( 0., 0., 0., 0. );
	if( v >= 1.0 )
		return vec4( 1., 1., 1., 1. );
	float vuf;
	float af = modf( v * PackFactors.a, vuf );
	float bf = modf( vuf * ShiftRight8, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec4( vuf * Inv255, gf * PackUpscale, bf * PackUpscale, af );
}
vec3 packDepthToRGB( const in float v ) {
	if( v <= 0.0 )
		return vec3( 0., 0., 0. );
	if( v >= 1.0 )
		return vec3( 1., 1., 1. );
	float vuf;
	float bf = modf( v * PackFactors.b, vuf );
	float gf = modf( vuf * ShiftRight8, vuf );
	return vec3( vuf * Inv255, gf * PackUpscale, bf );
}
vec2 packDepthToRG( const in float v ) {
	if( v <= 0.0 )
		return vec2( 0., 0. );
	if( v >= 1.0 )
		return vec2( 1., 1. );
	float vuf;
	float gf = modf( v * 256., vuf );
	return vec2( vuf * Inv255, gf );
}
float unpackRGBAToDepth( const in vec4 v ) {
	return dot( v, UnpackFactors4 );
}
float unpackRGBToDepth( const in vec3 v ) {
	return dot( v, UnpackFactors3 );
}
float unpackRGToDepth( const in vec2 v ) {
	return v.r * UnpackFactors2.r + v.g * UnpackFactors2.g;
}
vec4 pack2HalfToRGBA( const in vec2 v ) {
	vec4 r = vec4( v.x, fract( v.x * 255.0 ), v.y, fract( v.y * 255.0 ) );
	return vec4( r.x - r.y / 255.0, r.y, r.z - r.w / 255.0, r.w );
}
vec2 unpackRGBATo2Half( const in vec4 v ) {
	return vec2( v.x + ( v.y / 255.0 ), v.z + ( v.w / 255.0 ) );
}
float viewZToOrthographicDepth( const in float viewZ, const in float near, const in float far ) {
	return ( viewZ + near ) / ( near - far );
}
float orthographicDepthToViewZ( const in float depth, const in float near, const in float far ) {
	#ifdef USE_REVERSED_DEPTH_BUFFER
	
		return depth * ( far - near ) - far;
	#else
		return depth * ( near - far ) - near;
	#endif
}
float viewZToPerspectiveDepth( const in float viewZ, const in float near, const in float far ) {
	return ( ( near + viewZ ) * far ) / ( ( far - near ) * viewZ );
}
float perspectiveDepthToViewZ( const in float depth, const in float near, const in float far ) {
	
	#ifdef USE_REVERSED_DEPTH_BUFFER
		return ( near * far ) / ( ( near - far ) * depth - near );
	#else
		return ( near * far ) / ( ( far - near ) * depth - far );
	#endif
}`,VS=`#ifdef PREMULTIPLIED_ALPHA
	gl_FragColor.rgb *= gl_FragColor.a;
#endif`,HS=`vec4 mvPosition = vec4( transformed, 1.0 );
#ifdef USE_BATCHING
	mvPosition = batchingMatrix * mvPosition;
#endif
#ifdef USE_INSTANCING
	mvPosition = instanceMatrix * mvPosition;
#endif
mvPosition = modelViewMatrix * mvPosition;
gl_Position = projectionMatrix * mvPosition;`,GS=`#ifdef DITHERING
	gl_FragColor.rgb = dithering( gl_FragColor.rgb );
#endif`,WS=`#ifdef DITHERING
	vec3 dithering( vec3 color ) {
		float grid_position = rand( gl_FragCoord.xy );
		vec3 dither_shift_RGB = vec3( 0.25 / 255.0, -0.25 / 255.0, 0.25 / 255.0 );
		dither_shift_RGB = mix( 2.0 * dither_shift_RGB, -2.0 * dither_shift_RGB, grid_position );
		return color + dither_shift_RGB;
	}
#endif`,XS=`float roughnessFactor = roughness;
#ifdef USE_ROUGHNESSMAP
	vec4 texelRoughness = texture2D( roughnessMap, vRoughnessMapUv );
	roughnessFactor *= texelRoughness.g;
#endif`,$S=`#ifdef USE_ROUGHNESSMAP
	uniform sampler2D roughnessMap;
#endif`,qS=`#if NUM_SPOT_LIGHT_COORDS > 0
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#if NUM_SPOT_LIGHT_MAPS > 0
	uniform sampler2D spotLightMap[ NUM_SPOT_LIGHT_MAPS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		#define SUN_LIGHT_CASCADES 2
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#else
			uniform sampler2D sunShadowMap[ NUM_SUN_LIGHT_SHADOWS ];
		#endif
		uniform mat4 sunShadowMatrix[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		uniform vec4 sunShadowCascade[ NUM_SUN_LIGHT_SHADOWS * SUN_LIGHT_CASCADES ];
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
		struct SunLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SunLightShadow sunLightShadows[ NUM_SUN_LIGHT_SHADOWS ];
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#else
			uniform sampler2D directionalShadowMap[ NUM_DIR_LIGHT_SHADOWS ];
		#endif
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform sampler2DShadow spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#else
			uniform sampler2D spotShadowMap[ NUM_SPOT_LIGHT_SHADOWS ];
		#endif
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#if defined( SHADOWMAP_TYPE_PCF )
			uniform samplerCubeShadow pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#elif defined( SHADOWMAP_TYPE_BASIC )
			uniform samplerCube pointShadowMap[ NUM_POINT_LIGHT_SHADOWS ];
		#endif
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float interleavedGradientNoise( vec2 position ) {
			return fract( 52.9829189 * fract( dot( position, vec2( 0.06711056, 0.00583715 ) ) ) );
		}
		vec2 vogelDiskSample( int sampleIndex, int samplesCount, float phi ) {
			const float goldenAngle = 2.399963229728653;
			float r = sqrt( ( float( sampleIndex ) + 0.5 ) / float( samplesCount ) );
			float theta = float( sampleIndex ) * goldenAngle + phi;
			return vec2( cos( theta ), sin( theta ) ) * r;
		}
	#endif
	#if defined( SHADOWMAP_TYPE_PCF )
		float getShadow( sampler2DShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 texelSize = vec2( 1.0 ) / shadowMapSize;
				vec2 radius = shadowRadius * texelSize;
				float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
				shadow = (
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 0, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 1, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 2, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 3, 5, phi ) * radius, shadowCoord.z ) ) +
					texture( shadowMap, vec3( shadowCoord.xy + vogelDiskSample( 4, 5, phi ) * radius, shadowCoord.z ) )
				) * 0.2;
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#elif defined( SHADOWMAP_TYPE_VSM )
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				vec2 distribution = texture2D( shadowMap, shadowCoord.xy ).rg;
				float mean = distribution.x;
				float variance = distribution.y * distribution.y;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					float hard_shadow = step( mean, shadowCoord.z );
				#else
					float hard_shadow = step( shadowCoord.z, mean );
				#endif
				
				if ( hard_shadow == 1.0 ) {
					shadow = 1.0;
				} else {
					variance = max( variance, 0.0000001 );
					float d = shadowCoord.z - mean;
					float p_max = variance / ( variance + d * d );
					p_max = clamp( ( p_max - 0.3 ) / 0.65, 0.0, 1.0 );
					shadow = max( hard_shadow, p_max );
				}
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#else
		float getShadow( sampler2D shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord ) {
			float shadow = 1.0;
			shadowCoord.xyz /= shadowCoord.w;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				shadowCoord.z -= shadowBias;
			#else
				shadowCoord.z += shadowBias;
			#endif
			bool inFrustum = shadowCoord.x >= 0.0 && shadowCoord.x <= 1.0 && shadowCoord.y >= 0.0 && shadowCoord.y <= 1.0;
			bool frustumTest = inFrustum && shadowCoord.z <= 1.0;
			if ( frustumTest ) {
				float depth = texture2D( shadowMap, shadowCoord.xy ).r;
				#ifdef USE_REVERSED_DEPTH_BUFFER
					shadow = step( depth, shadowCoord.z );
				#else
					shadow = step( shadowCoord.z, depth );
				#endif
			}
			return mix( 1.0, shadow, shadowIntensity );
		}
	#endif
	#if NUM_SUN_LIGHT_SHADOWS > 0
		float getSunShadow(
			#if defined( SHADOWMAP_TYPE_PCF )
				sampler2DShadow shadowMap,
			#else
				sampler2D shadowMap,
			#endif
			SunLightShadow sunLightShadow,
			int shadowIndex
		) {
			vec4 shadowWorldPosition = vec4( vSunShadowWorldPosition.xyz + vSunShadowWorldNormal * sunLightShadow.shadowNormalBias, 1.0 );
			float viewDepth = vSunShadowWorldPosition.w;
			int cascadeOffset = shadowIndex * SUN_LIGHT_CASCADES;
			float shadow = 1.0;
			for ( int i = SUN_LIGHT_CASCADES - 1; i >= 0; i -- ) {
				vec4 cascade = sunShadowCascade[ cascadeOffset + i ];
				if ( viewDepth >= cascade.x && viewDepth < cascade.y ) {
					float cascadeShadow = getShadow(
						shadowMap,
						sunLightShadow.shadowMapSize,
						sunLightShadow.shadowIntensity,
						sunLightShadow.shadowBias,
						sunLightShadow.shadowRadius,
						sunShadowMatrix[ cascadeOffset + i ] * shadowWorldPosition
					);
					shadow = mix( cascadeShadow, shadow, smoothstep( cascade.z, cascade.y, viewDepth ) );
				}
			}
			return shadow;
		}
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
	#if defined( SHADOWMAP_TYPE_PCF )
	float getPointShadow( samplerCubeShadow shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 bd3D = normalize( lightToPosition );
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float lightDistance = length( lightToPosition );
			float depthRange = shadowCameraFar - shadowCameraNear;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				float depthA = - shadowCameraNear / depthRange - shadowBias;
				float depthB = shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#else
				float depthA = shadowCameraFar / depthRange + shadowBias;
				float depthB = - shadowCameraNear * shadowCameraFar / ( depthRange * lightDistance );
			#endif
			float texelSize = shadowRadius / shadowMapSize.x;
			vec3 absDir = abs( bd3D );
			vec3 tangent = absDir.x > absDir.z ? vec3( 0.0, 1.0, 0.0 ) : vec3( 1.0, 0.0, 0.0 );
			tangent = normalize( cross( bd3D, tangent ) );
			vec3 bitangent = cross( bd3D, tangent );
			float phi = interleavedGradientNoise( gl_FragCoord.xy ) * PI2;
			shadow = 0.0;
			for ( int i = 0; i < 5; i ++ ) {
				vec2 offset = vogelDiskSample( i, 5, phi );
				vec3 direction = bd3D + ( tangent * offset.x + bitangent * offset.y ) * texelSize;
				vec3 absDirection = abs( direction );
				float dp = depthA + depthB / max( max( absDirection.x, absDirection.y ), absDirection.z );
				shadow += texture( shadowMap, vec4( direction, dp ) );
			}
			shadow *= 0.2;
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#elif defined( SHADOWMAP_TYPE_BASIC )
	float getPointShadow( samplerCube shadowMap, vec2 shadowMapSize, float shadowIntensity, float shadowBias, float shadowRadius, vec4 shadowCoord, float shadowCameraNear, float shadowCameraFar ) {
		float shadow = 1.0;
		vec3 lightToPosition = shadowCoord.xyz;
		vec3 absVec = abs( lightToPosition );
		float viewSpaceZ = max( max( absVec.x, absVec.y ), absVec.z );
		if ( viewSpaceZ - shadowCameraFar <= 0.0 && viewSpaceZ - shadowCameraNear >= 0.0 ) {
			float dp = ( shadowCameraFar * ( viewSpaceZ - shadowCameraNear ) ) / ( viewSpaceZ * ( shadowCameraFar - shadowCameraNear ) );
			dp += shadowBias;
			vec3 bd3D = normalize( lightToPosition );
			float depth = textureCube( shadowMap, bd3D ).r;
			#ifdef USE_REVERSED_DEPTH_BUFFER
				depth = 1.0 - depth;
			#endif
			shadow = step( dp, depth );
		}
		return mix( 1.0, shadow, shadowIntensity );
	}
	#endif
	#endif
#endif`,YS=`#if NUM_SPOT_LIGHT_COORDS > 0
	uniform mat4 spotLightMatrix[ NUM_SPOT_LIGHT_COORDS ];
	varying vec4 vSpotLightCoord[ NUM_SPOT_LIGHT_COORDS ];
#endif
#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
		varying vec4 vSunShadowWorldPosition;
		varying vec3 vSunShadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		uniform mat4 directionalShadowMatrix[ NUM_DIR_LIGHT_SHADOWS ];
		varying vec4 vDirectionalShadowCoord[ NUM_DIR_LIGHT_SHADOWS ];
		struct DirectionalLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform DirectionalLightShadow directionalLightShadows[ NUM_DIR_LIGHT_SHADOWS ];
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
		struct SpotLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
		};
		uniform SpotLightShadow spotLightShadows[ NUM_SPOT_LIGHT_SHADOWS ];
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		uniform mat4 pointShadowMatrix[ NUM_POINT_LIGHT_SHADOWS ];
		varying vec4 vPointShadowCoord[ NUM_POINT_LIGHT_SHADOWS ];
		struct PointLightShadow {
			float shadowIntensity;
			float shadowBias;
			float shadowNormalBias;
			float shadowRadius;
			vec2 shadowMapSize;
			float shadowCameraNear;
			float shadowCameraFar;
		};
		uniform PointLightShadow pointLightShadows[ NUM_POINT_LIGHT_SHADOWS ];
	#endif
#endif`,ZS=`#if ( defined( USE_SHADOWMAP ) && ( NUM_DIR_LIGHT_SHADOWS > 0 || NUM_SUN_LIGHT_SHADOWS > 0 || NUM_POINT_LIGHT_SHADOWS > 0 ) ) || ( NUM_SPOT_LIGHT_COORDS > 0 )
	#ifdef HAS_NORMAL
		vec3 shadowWorldNormal = transformNormalByInverseViewMatrix( transformedNormal, viewMatrix );
	#else
		vec3 shadowWorldNormal = vec3( 0.0 );
	#endif
	vec4 shadowWorldPosition;
#endif
#if defined( USE_SHADOWMAP )
	#if NUM_SUN_LIGHT_SHADOWS > 0
		vSunShadowWorldPosition = vec4( worldPosition.xyz, - mvPosition.z );
		vSunShadowWorldNormal = shadowWorldNormal;
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * directionalLightShadows[ i ].shadowNormalBias, 0 );
			vDirectionalShadowCoord[ i ] = directionalShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0
		#pragma unroll_loop_start
		for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
			shadowWorldPosition = worldPosition + vec4( shadowWorldNormal * pointLightShadows[ i ].shadowNormalBias, 0 );
			vPointShadowCoord[ i ] = pointShadowMatrix[ i ] * shadowWorldPosition;
		}
		#pragma unroll_loop_end
	#endif
#endif
#if NUM_SPOT_LIGHT_COORDS > 0
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_COORDS; i ++ ) {
		shadowWorldPosition = worldPosition;
		#if ( defined( USE_SHADOWMAP ) && UNROLLED_LOOP_INDEX < NUM_SPOT_LIGHT_SHADOWS )
			shadowWorldPosition.xyz += shadowWorldNormal * spotLightShadows[ i ].shadowNormalBias;
		#endif
		vSpotLightCoord[ i ] = spotLightMatrix[ i ] * shadowWorldPosition;
	}
	#pragma unroll_loop_end
#endif`,KS=`float getShadowMask() {
	float shadow = 1.0;
	#ifdef USE_SHADOWMAP
	#if NUM_SUN_LIGHT_SHADOWS > 0
	SunLightShadow sunLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SUN_LIGHT_SHADOWS; i ++ ) {
		sunLight = sunLightShadows[ i ];
		shadow *= receiveShadow ? getSunShadow( sunShadowMap[ i ], sunLight, UNROLLED_LOOP_INDEX ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_DIR_LIGHT_SHADOWS > 0
	DirectionalLightShadow directionalLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_DIR_LIGHT_SHADOWS; i ++ ) {
		directionalLight = directionalLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( directionalShadowMap[ i ], directionalLight.shadowMapSize, directionalLight.shadowIntensity, directionalLight.shadowBias, directionalLight.shadowRadius, vDirectionalShadowCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_SPOT_LIGHT_SHADOWS > 0
	SpotLightShadow spotLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_SPOT_LIGHT_SHADOWS; i ++ ) {
		spotLight = spotLightShadows[ i ];
		shadow *= receiveShadow ? getShadow( spotShadowMap[ i ], spotLight.shadowMapSize, spotLight.shadowIntensity, spotLight.shadowBias, spotLight.shadowRadius, vSpotLightCoord[ i ] ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#if NUM_POINT_LIGHT_SHADOWS > 0 && ( defined( SHADOWMAP_TYPE_PCF ) || defined( SHADOWMAP_TYPE_BASIC ) )
	PointLightShadow pointLight;
	#pragma unroll_loop_start
	for ( int i = 0; i < NUM_POINT_LIGHT_SHADOWS; i ++ ) {
		pointLight = pointLightShadows[ i ];
		shadow *= receiveShadow ? getPointShadow( pointShadowMap[ i ], pointLight.shadowMapSize, pointLight.shadowIntensity, pointLight.shadowBias, pointLight.shadowRadius, vPointShadowCoord[ i ], pointLight.shadowCameraNear, pointLight.shadowCameraFar ) : 1.0;
	}
	#pragma unroll_loop_end
	#endif
	#endif
	return shadow;
}`,JS=`#ifdef USE_SKINNING
	mat4 boneMatX = getBoneMatrix( skinIndex.x );
	mat4 boneMatY = getBoneMatrix( skinIndex.y );
	mat4 boneMatZ = getBoneMatrix( skinIndex.z );
	mat4 boneMatW = getBoneMatrix( skinIndex.w );
#endif`,jS=`#ifdef USE_SKINNING
	uniform mat4 bindMatrix;
	uniform mat4 bindMatrixInverse;
	uniform highp sampler2D boneTexture;
	mat4 getBoneMatrix( const in float i ) {
		int size = textureSize( boneTexture, 0 ).x;
		int j = int( i ) * 4;
		int x = j % size;
		int y = j / size;
		vec4 v1 = texelFetch( boneTexture, ivec2( x, y ), 0 );
		vec4 v2 = texelFetch( boneTexture, ivec2( x + 1, y ), 0 );
		vec4 v3 = texelFetch( boneTexture, ivec2( x + 2, y ), 0 );
		vec4 v4 = texelFetch( boneTexture, ivec2( x + 3, y ), 0 );
		return mat4( v1, v2, v3, v4 );
	}
#endif`,QS=`#ifdef USE_SKINNING
	vec4 skinVertex = bindMatrix * vec4( transformed, 1.0 );
	vec4 skinned = vec4( 0.0 );
	skinned += boneMatX * skinVertex * skinWeight.x;
	skinned += boneMatY * skinVertex * skinWeight.y;
	skinned += boneMatZ * skinVertex * skinWeight.z;
	skinned += boneMatW * skinVertex * skinWeight.w;
	transformed = ( bindMatrixInverse * skinned ).xyz;
#endif`,ew=`#ifdef USE_SKINNING
	mat4 skinMatrix = mat4( 0.0 );
	skinMatrix += skinWeight.x * boneMatX;
	skinMatrix += skinWeight.y * boneMatY;
	skinMatrix += skinWeight.z * boneMatZ;
	skinMatrix += skinWeight.w * boneMatW;
	skinMatrix = bindMatrixInverse * skinMatrix * bindMatrix;
	objectNormal = vec4( skinMatrix * vec4( objectNormal, 0.0 ) ).xyz;
	#ifdef USE_TANGENT
		objectTangent = vec4( skinMatrix * vec4( objectTangent, 0.0 ) ).xyz;
	#endif
#endif`,tw=`float specularStrength;
#ifdef USE_SPECULARMAP
	vec4 texelSpecular = texture2D( specularMap, vSpecularMapUv );
	specularStrength = texelSpecular.r;
#else
	specularStrength = 1.0;
#endif`,nw=`#ifdef USE_SPECULARMAP
	uniform sampler2D specularMap;
#endif`,iw=`#if defined( TONE_MAPPING )
	gl_FragColor.rgb = toneMapping( gl_FragColor.rgb );
#endif`,sw=`#ifndef saturate
#define saturate( a ) clamp( a, 0.0, 1.0 )
#endif
uniform float toneMappingExposure;
vec3 LinearToneMapping( vec3 color ) {
	return saturate( toneMappingExposure * color );
}
vec3 ReinhardToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	return saturate( color / ( vec3( 1.0 ) + color ) );
}
vec3 CineonToneMapping( vec3 color ) {
	color *= toneMappingExposure;
	color = max( vec3( 0.0 ), color - 0.004 );
	return pow( ( color * ( 6.2 * color + 0.5 ) ) / ( color * ( 6.2 * color + 1.7 ) + 0.06 ), vec3( 2.2 ) );
}
vec3 RRTAndODTFit( vec3 v ) {
	vec3 a = v * ( v + 0.0245786 ) - 0.000090537;
	vec3 b = v * ( 0.983729 * v + 0.4329510 ) + 0.238081;
	return a / b;
}
vec3 ACESFilmicToneMapping( vec3 color ) {
	const mat3 ACESInputMat = mat3(
		vec3( 0.59719, 0.07600, 0.02840 ),		vec3( 0.35458, 0.90834, 0.13383 ),
		vec3( 0.04823, 0.01566, 0.83777 )
	);
	const mat3 ACESOutputMat = mat3(
		vec3(  1.60475, -0.10208, -0.00327 ),		vec3( -0.53108,  1.10813, -0.07276 ),
		vec3( -0.07367, -0.00605,  1.07602 )
	);
	color *= toneMappingExposure / 0.6;
	color = ACESInputMat * color;
	color = RRTAndODTFit( color );
	color = ACESOutputMat * color;
	return saturate( color );
}
const mat3 LINEAR_REC2020_TO_LINEAR_SRGB = mat3(
	vec3( 1.6605, - 0.1246, - 0.0182 ),
	vec3( - 0.5876, 1.1329, - 0.1006 ),
	vec3( - 0.0728, - 0.0083, 1.1187 )
);
const mat3 LINEAR_SRGB_TO_LINEAR_REC2020 = mat3(
	vec3( 0.6274, 0.0691, 0.0164 ),
	vec3( 0.3293, 0.9195, 0.0880 ),
	vec3( 0.0433, 0.0113, 0.8956 )
);
vec3 agxDefaultContrastApprox( vec3 x ) {
	vec3 x2 = x * x;
	vec3 x4 = x2 * x2;
	return + 15.5 * x4 * x2
		- 40.14 * x4 * x
		+ 31.96 * x4
		- 6.868 * x2 * x
		+ 0.4298 * x2
		+ 0.1191 * x
		- 0.00232;
}
vec3 AgXToneMapping( vec3 color ) {
	const mat3 AgXInsetMatrix = mat3(
		vec3( 0.856627153315983, 0.137318972929847, 0.11189821299995 ),
		vec3( 0.0951212405381588, 0.761241990602591, 0.0767994186031903 ),
		vec3( 0.0482516061458583, 0.101439036467562, 0.811302368396859 )
	);
	const mat3 AgXOutsetMatrix = mat3(
		vec3( 1.1271005818144368, - 0.1413297634984383, - 0.14132976349843826 ),
		vec3( - 0.11060664309660323, 1.157823702216272, - 0.11060664309660294 ),
		vec3( - 0.016493938717834573, - 0.016493938717834257, 1.2519364065950405 )
	);
	const float AgxMinEv = - 12.47393;	const float AgxMaxEv = 4.026069;
	color *= toneMappingExposure;
	color = LINEAR_SRGB_TO_LINEAR_REC2020 * color;
	color = AgXInsetMatrix * color;
	color = max( color, 1e-10 );	color = log2( color );
	color = ( color - AgxMinEv ) / ( AgxMaxEv - AgxMinEv );
	color = clamp( color, 0.0, 1.0 );
	color = agxDefaultContrastApprox( color );
	color = AgXOutsetMatrix * color;
	color = pow( max( vec3( 0.0 ), color ), vec3( 2.2 ) );
	color = LINEAR_REC2020_TO_LINEAR_SRGB * color;
	color = clamp( color, 0.0, 1.0 );
	return color;
}
vec3 NeutralToneMapping( vec3 color ) {
	const float StartCompression = 0.8 - 0.04;
	const float Desaturation = 0.15;
	color *= toneMappingExposure;
	float x = min( color.r, min( color.g, color.b ) );
	float offset = x < 0.08 ? x - 6.25 * x * x : 0.04;
	color -= offset;
	float peak = max( color.r, max( color.g, color.b ) );
	if ( peak < StartCompression ) return color;
	float d = 1. - StartCompression;
	float newPeak = 1. - d * d / ( peak + d - StartCompression );
	color *= newPeak / peak;
	float g = 1. - 1. / ( Desaturation * ( peak - newPeak ) + 1. );
	return mix( color, vec3( newPeak ), g );
}
vec3 CustomToneMapping( vec3 color ) { return color; }`,rw=`#ifdef USE_TRANSMISSION
	material.transmission = transmission;
	material.transmissionAlpha = 1.0;
	material.thickness = thickness;
	material.attenuationDistance = attenuationDistance;
	material.attenuationColor = attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		material.transmission *= texture2D( transmissionMap, vTransmissionMapUv ).r;
	#endif
	#ifdef USE_THICKNESSMAP
		material.thickness *= texture2D( thicknessMap, vThicknessMapUv ).g;
	#endif
	vec3 pos = vWorldPosition;
	vec3 v = normalize( cameraPosition - pos );
	vec3 n = transformNormalByInverseViewMatrix( normal, viewMatrix );
	vec4 transmitted = getIBLVolumeRefraction(
		n, v, material.roughness, material.diffuseContribution, material.specularColorBlended, material.specularF90,
		pos, modelMatrix, viewMatrix, projectionMatrix, material.dispersion, material.ior, material.thickness,
		material.attenuationColor, material.attenuationDistance );
	material.transmissionAlpha = mix( material.transmissionAlpha, transmitted.a, material.transmission );
	totalDiffuse = mix( totalDiffuse, transmitted.rgb, material.transmission );
#endif`,ow=`#ifdef USE_TRANSMISSION
	uniform float transmission;
	uniform float thickness;
	uniform float attenuationDistance;
	uniform vec3 attenuationColor;
	#ifdef USE_TRANSMISSIONMAP
		uniform sampler2D transmissionMap;
	#endif
	#ifdef USE_THICKNESSMAP
		uniform sampler2D thicknessMap;
	#endif
	uniform vec2 transmissionSamplerSize;
	uniform sampler2D transmissionSamplerMap;
	uniform mat4 modelMatrix;
	uniform mat4 projectionMatrix;
	varying vec3 vWorldPosition;
	float w0( float a ) {
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - a + 3.0 ) - 3.0 ) + 1.0 );
	}
	float w1( float a ) {
		return ( 1.0 / 6.0 ) * ( a *  a * ( 3.0 * a - 6.0 ) + 4.0 );
	}
	float w2( float a ){
		return ( 1.0 / 6.0 ) * ( a * ( a * ( - 3.0 * a + 3.0 ) + 3.0 ) + 1.0 );
	}
	float w3( float a ) {
		return ( 1.0 / 6.0 ) * ( a * a * a );
	}
	float g0( float a ) {
		return w0( a ) + w1( a );
	}
	float g1( float a ) {
		return w2( a ) + w3( a );
	}
	float h0( float a ) {
		return - 1.0 + w1( a ) / ( w0( a ) + w1( a ) );
	}
	float h1( float a ) {
		return 1.0 + w3( a ) / ( w2( a ) + w3( a ) );
	}
	vec4 bicubic( sampler2D tex, vec2 uv, vec4 texelSize, float lod ) {
		uv = uv * texelSize.zw + 0.5;
		vec2 iuv = floor( uv );
		vec2 fuv = fract( uv );
		float g0x = g0( fuv.x );
		float g1x = g1( fuv.x );
		float h0x = h0( fuv.x );
		float h1x = h1( fuv.x );
		float h0y = h0( fuv.y );
		float h1y = h1( fuv.y );
		vec2 p0 = ( vec2( iuv.x + h0x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p1 = ( vec2( iuv.x + h1x, iuv.y + h0y ) - 0.5 ) * texelSize.xy;
		vec2 p2 = ( vec2( iuv.x + h0x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		vec2 p3 = ( vec2( iuv.x + h1x, iuv.y + h1y ) - 0.5 ) * texelSize.xy;
		return g0( fuv.y ) * ( g0x * textureLod( tex, p0, lod ) + g1x * textureLod( tex, p1, lod ) ) +
			g1( fuv.y ) * ( g0x * textureLod( tex, p2, lod ) + g1x * textureLod( tex, p3, lod ) );
	}
	vec4 textureBicubic( sampler2D sampler, vec2 uv, float lod ) {
		vec2 fLodSize = vec2( textureSize( sampler, int( lod ) ) );
		vec2 cLodSize = vec2( textureSize( sampler, int( lod + 1.0 ) ) );
		vec2 fLodSizeInv = 1.0 / fLodSize;
		vec2 cLodSizeInv = 1.0 / cLodSize;
		vec4 fSample = bicubic( sampler, uv, vec4( fLodSizeInv, fLodSize ), floor( lod ) );
		vec4 cSample = bicubic( sampler, uv, vec4( cLodSizeInv, cLodSize ), ceil( lod ) );
		return mix( fSample, cSample, fract( lod ) );
	}
	vec3 getVolumeTransmissionRay( const in vec3 n, const in vec3 v, const in float thickness, const in float ior, const in mat4 modelMatrix ) {
		vec3 refractionVector = refract( - v, normalize( n ), 1.0 / ior );
		vec3 modelScale;
		modelScale.x = length( vec3( modelMatrix[ 0 ].xyz ) );
		modelScale.y = length( vec3( modelMatrix[ 1 ].xyz ) );
		modelScale.z = length( vec3( modelMatrix[ 2 ].xyz ) );
		return normalize( refractionVector ) * thickness * modelScale;
	}
	float applyIorToRoughness( const in float roughness, const in float ior ) {
		return roughness * clamp( ior * 2.0 - 2.0, 0.0, 1.0 );
	}
	vec4 getTransmissionSample( const in vec2 fragCoord, const in float roughness, const in float ior ) {
		float lod = log2( transmissionSamplerSize.x ) * applyIorToRoughness( roughness, ior );
		return textureBicubic( transmissionSamplerMap, fragCoord.xy, lod );
	}
	vec3 volumeAttenuation( const in float transmissionDistance, const in vec3 attenuationColor, const in float attenuationDistance ) {
		if ( isinf( attenuationDistance ) ) {
			return vec3( 1.0 );
		} else {
			vec3 attenuationCoefficient = -log( attenuationColor ) / attenuationDistance;
			vec3 transmittance = exp( - attenuationCoefficient * transmissionDistance );			return transmittance;
		}
	}
	vec4 getIBLVolumeRefraction( const in vec3 n, const in vec3 v, const in float roughness, const in vec3 diffuseColor,
		const in vec3 specularColor, const in float specularF90, const in vec3 position, const in mat4 modelMatrix,
		const in mat4 viewMatrix, const in mat4 projMatrix, const in float dispersion, const in float ior, const in float thickness,
		const in vec3 attenuationColor, const in float attenuationDistance ) {
		vec4 transmittedLight;
		vec3 transmittance;
		#ifdef USE_DISPERSION
			float halfSpread = ( ior - 1.0 ) * 0.025 * dispersion;
			vec3 iors = vec3( ior - halfSpread, ior, ior + halfSpread );
			for ( int i = 0; i < 3; i ++ ) {
				vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, iors[ i ], modelMatrix );
				vec3 refractedRayExit = position + transmissionRay;
				vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
				vec2 refractionCoords = ndcPos.xy / ndcPos.w;
				refractionCoords += 1.0;
				refractionCoords /= 2.0;
				vec4 transmissionSample = getTransmissionSample( refractionCoords, roughness, iors[ i ] );
				transmittedLight[ i ] = transmissionSample[ i ];
				transmittedLight.a += transmissionSample.a;
				transmittance[ i ] = diffuseColor[ i ] * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance )[ i ];
			}
			transmittedLight.a /= 3.0;
		#else
			vec3 transmissionRay = getVolumeTransmissionRay( n, v, thickness, ior, modelMatrix );
			vec3 refractedRayExit = position + transmissionRay;
			vec4 ndcPos = projMatrix * viewMatrix * vec4( refractedRayExit, 1.0 );
			vec2 refractionCoords = ndcPos.xy / ndcPos.w;
			refractionCoords += 1.0;
			refractionCoords /= 2.0;
			transmittedLight = getTransmissionSample( refractionCoords, roughness, ior );
			transmittance = diffuseColor * volumeAttenuation( length( transmissionRay ), attenuationColor, attenuationDistance );
		#endif
		vec3 attenuatedColor = transmittance * transmittedLight.rgb;
		vec3 F = EnvironmentBRDF( n, v, specularColor, specularF90, roughness );
		float transmittanceFactor = ( transmittance.r + transmittance.g + transmittance.b ) / 3.0;
		return vec4( ( 1.0 - F ) * attenuatedColor, 1.0 - ( 1.0 - transmittedLight.a ) * transmittanceFactor );
	}
#endif`,aw=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_SPECULARMAP
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,lw=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	varying vec2 vUv;
#endif
#ifdef USE_MAP
	uniform mat3 mapTransform;
	varying vec2 vMapUv;
#endif
#ifdef USE_ALPHAMAP
	uniform mat3 alphaMapTransform;
	varying vec2 vAlphaMapUv;
#endif
#ifdef USE_LIGHTMAP
	uniform mat3 lightMapTransform;
	varying vec2 vLightMapUv;
#endif
#ifdef USE_AOMAP
	uniform mat3 aoMapTransform;
	varying vec2 vAoMapUv;
#endif
#ifdef USE_BUMPMAP
	uniform mat3 bumpMapTransform;
	varying vec2 vBumpMapUv;
#endif
#ifdef USE_NORMALMAP
	uniform mat3 normalMapTransform;
	varying vec2 vNormalMapUv;
#endif
#ifdef USE_DISPLACEMENTMAP
	uniform mat3 displacementMapTransform;
	varying vec2 vDisplacementMapUv;
#endif
#ifdef USE_EMISSIVEMAP
	uniform mat3 emissiveMapTransform;
	varying vec2 vEmissiveMapUv;
#endif
#ifdef USE_METALNESSMAP
	uniform mat3 metalnessMapTransform;
	varying vec2 vMetalnessMapUv;
#endif
#ifdef USE_ROUGHNESSMAP
	uniform mat3 roughnessMapTransform;
	varying vec2 vRoughnessMapUv;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	uniform mat3 diffuseRoughnessMapTransform;
	varying vec2 vDiffuseRoughnessMapUv;
#endif
#ifdef USE_ANISOTROPYMAP
	uniform mat3 anisotropyMapTransform;
	varying vec2 vAnisotropyMapUv;
#endif
#ifdef USE_CLEARCOATMAP
	uniform mat3 clearcoatMapTransform;
	varying vec2 vClearcoatMapUv;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	uniform mat3 clearcoatNormalMapTransform;
	varying vec2 vClearcoatNormalMapUv;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	uniform mat3 clearcoatRoughnessMapTransform;
	varying vec2 vClearcoatRoughnessMapUv;
#endif
#ifdef USE_SHEEN_COLORMAP
	uniform mat3 sheenColorMapTransform;
	varying vec2 vSheenColorMapUv;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	uniform mat3 sheenRoughnessMapTransform;
	varying vec2 vSheenRoughnessMapUv;
#endif
#ifdef USE_IRIDESCENCEMAP
	uniform mat3 iridescenceMapTransform;
	varying vec2 vIridescenceMapUv;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	uniform mat3 iridescenceThicknessMapTransform;
	varying vec2 vIridescenceThicknessMapUv;
#endif
#ifdef USE_SPECULARMAP
	uniform mat3 specularMapTransform;
	varying vec2 vSpecularMapUv;
#endif
#ifdef USE_SPECULAR_COLORMAP
	uniform mat3 specularColorMapTransform;
	varying vec2 vSpecularColorMapUv;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	uniform mat3 specularIntensityMapTransform;
	varying vec2 vSpecularIntensityMapUv;
#endif
#ifdef USE_TRANSMISSIONMAP
	uniform mat3 transmissionMapTransform;
	varying vec2 vTransmissionMapUv;
#endif
#ifdef USE_THICKNESSMAP
	uniform mat3 thicknessMapTransform;
	varying vec2 vThicknessMapUv;
#endif`,cw=`#if defined( USE_UV ) || defined( USE_ANISOTROPY )
	vUv = vec3( uv, 1 ).xy;
#endif
#ifdef USE_MAP
	vMapUv = ( mapTransform * vec3( MAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ALPHAMAP
	vAlphaMapUv = ( alphaMapTransform * vec3( ALPHAMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_LIGHTMAP
	vLightMapUv = ( lightMapTransform * vec3( LIGHTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_AOMAP
	vAoMapUv = ( aoMapTransform * vec3( AOMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_BUMPMAP
	vBumpMapUv = ( bumpMapTransform * vec3( BUMPMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_NORMALMAP
	vNormalMapUv = ( normalMapTransform * vec3( NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DISPLACEMENTMAP
	vDisplacementMapUv = ( displacementMapTransform * vec3( DISPLACEMENTMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_EMISSIVEMAP
	vEmissiveMapUv = ( emissiveMapTransform * vec3( EMISSIVEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_METALNESSMAP
	vMetalnessMapUv = ( metalnessMapTransform * vec3( METALNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ROUGHNESSMAP
	vRoughnessMapUv = ( roughnessMapTransform * vec3( ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_DIFFUSE_ROUGHNESSMAP
	vDiffuseRoughnessMapUv = ( diffuseRoughnessMapTransform * vec3( DIFFUSE_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_ANISOTROPYMAP
	vAnisotropyMapUv = ( anisotropyMapTransform * vec3( ANISOTROPYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOATMAP
	vClearcoatMapUv = ( clearcoatMapTransform * vec3( CLEARCOATMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_NORMALMAP
	vClearcoatNormalMapUv = ( clearcoatNormalMapTransform * vec3( CLEARCOAT_NORMALMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_CLEARCOAT_ROUGHNESSMAP
	vClearcoatRoughnessMapUv = ( clearcoatRoughnessMapTransform * vec3( CLEARCOAT_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCEMAP
	vIridescenceMapUv = ( iridescenceMapTransform * vec3( IRIDESCENCEMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_IRIDESCENCE_THICKNESSMAP
	vIridescenceThicknessMapUv = ( iridescenceThicknessMapTransform * vec3( IRIDESCENCE_THICKNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_COLORMAP
	vSheenColorMapUv = ( sheenColorMapTransform * vec3( SHEEN_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SHEEN_ROUGHNESSMAP
	vSheenRoughnessMapUv = ( sheenRoughnessMapTransform * vec3( SHEEN_ROUGHNESSMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULARMAP
	vSpecularMapUv = ( specularMapTransform * vec3( SPECULARMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_COLORMAP
	vSpecularColorMapUv = ( specularColorMapTransform * vec3( SPECULAR_COLORMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_SPECULAR_INTENSITYMAP
	vSpecularIntensityMapUv = ( specularIntensityMapTransform * vec3( SPECULAR_INTENSITYMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_TRANSMISSIONMAP
	vTransmissionMapUv = ( transmissionMapTransform * vec3( TRANSMISSIONMAP_UV, 1 ) ).xy;
#endif
#ifdef USE_THICKNESSMAP
	vThicknessMapUv = ( thicknessMapTransform * vec3( THICKNESSMAP_UV, 1 ) ).xy;
#endif`,hw=`#if defined( USE_ENVMAP ) || defined( DISTANCE ) || defined ( USE_SHADOWMAP ) || defined ( USE_TRANSMISSION ) || NUM_SPOT_LIGHT_COORDS > 0
	vec4 worldPosition = vec4( transformed, 1.0 );
	#ifdef USE_BATCHING
		worldPosition = batchingMatrix * worldPosition;
	#endif
	#ifdef USE_INSTANCING
		worldPosition = instanceMatrix * worldPosition;
	#endif
	worldPosition = modelMatrix * worldPosition;
#endif`,uw=`varying vec2 vUv;
uniform mat3 uvTransform;
void main() {
	vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	gl_Position = vec4( position.xy, 1.0, 1.0 );
}`,fw=`uniform sampler2D t2D;
uniform float backgroundIntensity;
varying vec2 vUv;
void main() {
	vec4 texColor = texture2D( t2D, vUv );
	#ifdef DECODE_VIDEO_TEXTURE
		texColor = vec4( mix( pow( texColor.rgb * 0.9478672986 + vec3( 0.0521327014 ), vec3( 2.4 ) ), texColor.rgb * 0.0773993808, vec3( lessThanEqual( texColor.rgb, vec3( 0.04045 ) ) ) ), texColor.w );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,dw=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,pw=`uniform float backgroundBlurriness;
uniform float backgroundIntensity;
uniform mat3 backgroundRotation;
varying vec3 vWorldDirection;
#include <envmap_common_pars_fragment>
void main() {
	#ifdef ENVMAP_TYPE_PMREM
		vec4 texColor = textureLod( envMap, backgroundRotation * vWorldDirection, roughnessToMip( backgroundBlurriness ) );
	#else
		vec4 texColor = textureCube( envMap, backgroundRotation * vWorldDirection );
	#endif
	texColor.rgb *= backgroundIntensity;
	gl_FragColor = texColor;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,mw=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
	gl_Position.z = gl_Position.w;
}`,gw=`uniform samplerCube tCube;
uniform float tFlip;
uniform float opacity;
varying vec3 vWorldDirection;
void main() {
	vec4 texColor = textureCube( tCube, vec3( tFlip * vWorldDirection.x, vWorldDirection.yz ) );
	gl_FragColor = texColor;
	gl_FragColor.a *= opacity;
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,yw=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
varying vec2 vHighPrecisionZW;
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vHighPrecisionZW = gl_Position.zw;
}`,_w=`#if DEPTH_PACKING == 3200
	uniform float opacity;
#endif
#include <common>
#include <packing>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
varying vec2 vHighPrecisionZW;
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#if DEPTH_PACKING == 3200
		diffuseColor.a = opacity;
	#endif
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <logdepthbuf_fragment>
	#ifdef USE_REVERSED_DEPTH_BUFFER
		float fragCoordZ = vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ];
	#else
		float fragCoordZ = 0.5 * vHighPrecisionZW[ 0 ] / vHighPrecisionZW[ 1 ] + 0.5;
	#endif
	#if DEPTH_PACKING == 3200
		gl_FragColor = vec4( vec3( 1.0 - fragCoordZ ), opacity );
	#elif DEPTH_PACKING == 3201
		gl_FragColor = packDepthToRGBA( fragCoordZ );
	#elif DEPTH_PACKING == 3202
		gl_FragColor = vec4( packDepthToRGB( fragCoordZ ), 1.0 );
	#elif DEPTH_PACKING == 3203
		gl_FragColor = vec4( packDepthToRG( fragCoordZ ), 0.0, 1.0 );
	#endif
}`,xw=`#define DISTANCE
varying vec3 vWorldPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <skinbase_vertex>
	#include <morphinstance_vertex>
	#ifdef USE_DISPLACEMENTMAP
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <worldpos_vertex>
	#include <clipping_planes_vertex>
	vWorldPosition = worldPosition.xyz;
}`,vw=`#define DISTANCE
uniform vec3 referencePosition;
uniform float nearDistance;
uniform float farDistance;
varying vec3 vWorldPosition;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 1.0 );
	#include <clipping_planes_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	float dist = length( vWorldPosition - referencePosition );
	dist = ( dist - nearDistance ) / ( farDistance - nearDistance );
	dist = saturate( dist );
	gl_FragColor = vec4( dist, 0.0, 0.0, 1.0 );
}`,bw=`varying vec3 vWorldDirection;
#include <common>
void main() {
	vWorldDirection = transformDirection( position, modelMatrix );
	#include <begin_vertex>
	#include <project_vertex>
}`,Mw=`uniform sampler2D tEquirect;
varying vec3 vWorldDirection;
#include <common>
void main() {
	vec3 direction = normalize( vWorldDirection );
	vec2 sampleUV = equirectUv( direction );
	gl_FragColor = texture2D( tEquirect, sampleUV );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
}`,Sw=`uniform float scale;
attribute float lineDistance;
varying float vLineDistance;
#include <common>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	vLineDistance = scale * lineDistance;
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,ww=`uniform vec3 diffuse;
uniform float opacity;
uniform float dashSize;
uniform float totalSize;
varying float vLineDistance;
#include <common>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	if ( mod( vLineDistance, totalSize ) > dashSize ) {
		discard;
	}
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,Aw=`#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#if defined ( USE_ENVMAP ) || defined ( USE_SKINNING )
		#include <beginnormal_vertex>
		#include <morphnormal_vertex>
		#include <skinbase_vertex>
		#include <skinnormal_vertex>
		#include <defaultnormal_vertex>
	#endif
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <fog_vertex>
}`,Ew=`uniform vec3 diffuse;
uniform float opacity;
#ifndef FLAT_SHADED
	varying vec3 vNormal;
#endif
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <fog_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	#ifdef USE_LIGHTMAP
		vec4 lightMapTexel = texture2D( lightMap, vLightMapUv );
		reflectedLight.indirectDiffuse += lightMapTexel.rgb * lightMapIntensity * RECIPROCAL_PI;
	#else
		reflectedLight.indirectDiffuse += vec3( 1.0 );
	#endif
	#include <aomap_fragment>
	reflectedLight.indirectDiffuse *= diffuseColor.rgb;
	vec3 outgoingLight = reflectedLight.indirectDiffuse;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Tw=`#define LAMBERT
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,Cw=`#define LAMBERT
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_lambert_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_lambert_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Rw=`#define MATCAP
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <color_pars_vertex>
#include <displacementmap_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
	vViewPosition = - mvPosition.xyz;
}`,Iw=`#define MATCAP
uniform vec3 diffuse;
uniform float opacity;
uniform sampler2D matcap;
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	vec3 viewDir = normalize( vViewPosition );
	vec3 x = normalize( vec3( viewDir.z, 0.0, - viewDir.x ) );
	vec3 y = cross( viewDir, x );
	vec2 uv = vec2( dot( x, normal ), dot( y, normal ) ) * 0.495 + 0.5;
	#ifdef USE_MATCAP
		vec4 matcapColor = texture2D( matcap, uv );
	#else
		vec4 matcapColor = vec4( vec3( mix( 0.2, 0.8, uv.y ) ), 1.0 );
	#endif
	vec3 outgoingLight = diffuseColor.rgb * matcapColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Pw=`#define NORMAL
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	vViewPosition = - mvPosition.xyz;
#endif
}`,Lw=`#define NORMAL
uniform float opacity;
#if defined( FLAT_SHADED ) || defined( USE_BUMPMAP ) || defined( USE_NORMALMAP_TANGENTSPACE )
	varying vec3 vViewPosition;
#endif
#include <uv_pars_fragment>
#include <normal_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( 0.0, 0.0, 0.0, opacity );
	#include <clipping_planes_fragment>
	#include <logdepthbuf_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	gl_FragColor = vec4( normalize( normal ) * 0.5 + 0.5, diffuseColor.a );
	#ifdef OPAQUE
		gl_FragColor.a = 1.0;
	#endif
}`,Dw=`#define PHONG
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <envmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <envmap_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,Nw=`#define PHONG
uniform vec3 diffuse;
uniform vec3 emissive;
uniform vec3 specular;
uniform float shininess;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_phong_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <specularmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <specularmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_phong_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + reflectedLight.directSpecular + reflectedLight.indirectSpecular + totalEmissiveRadiance;
	#include <envmap_fragment>
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Uw=`#define STANDARD
varying vec3 vViewPosition;
#ifdef USE_TRANSMISSION
	varying vec3 vWorldPosition;
#endif
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
#ifdef USE_TRANSMISSION
	vWorldPosition = worldPosition.xyz;
#endif
}`,Fw=`#define STANDARD
#ifdef PHYSICAL
	#define IOR
	#define USE_SPECULAR
#endif
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float roughness;
uniform float metalness;
uniform float opacity;
#ifdef IOR
	uniform float ior;
#endif
#ifdef USE_SPECULAR
	uniform float specularIntensity;
	uniform vec3 specularColor;
	#ifdef USE_SPECULAR_COLORMAP
		uniform sampler2D specularColorMap;
	#endif
	#ifdef USE_SPECULAR_INTENSITYMAP
		uniform sampler2D specularIntensityMap;
	#endif
#endif
#ifdef USE_CLEARCOAT
	uniform float clearcoat;
	uniform float clearcoatRoughness;
#endif
#ifdef USE_DIFFUSE_ROUGHNESS
	uniform float diffuseRoughness;
	#ifdef USE_DIFFUSE_ROUGHNESSMAP
		uniform sampler2D diffuseRoughnessMap;
	#endif
#endif
#ifdef USE_DISPERSION
	uniform float dispersion;
#endif
#ifdef USE_RETROREFLECTION
	uniform float retroreflectivity;
#endif
#ifdef USE_IRIDESCENCE
	uniform float iridescence;
	uniform float iridescenceIOR;
	uniform float iridescenceThicknessMinimum;
	uniform float iridescenceThicknessMaximum;
#endif
#ifdef USE_SHEEN
	uniform vec3 sheenColor;
	uniform float sheenRoughness;
	#ifdef USE_SHEEN_COLORMAP
		uniform sampler2D sheenColorMap;
	#endif
	#ifdef USE_SHEEN_ROUGHNESSMAP
		uniform sampler2D sheenRoughnessMap;
	#endif
#endif
#ifdef USE_ANISOTROPY
	uniform vec2 anisotropyVector;
	#ifdef USE_ANISOTROPYMAP
		uniform sampler2D anisotropyMap;
	#endif
#endif
varying vec3 vViewPosition;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <iridescence_fragment>
#include <envmap_common_pars_fragment>
#include <envmap_physical_pars_fragment>
#include <fog_pars_fragment>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_physical_pars_fragment>
#include <transmission_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <clearcoat_pars_fragment>
#include <iridescence_pars_fragment>
#include <roughnessmap_pars_fragment>
#include <metalnessmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <roughnessmap_fragment>
	#include <metalnessmap_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <clearcoat_normal_fragment_begin>
	#include <clearcoat_normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_physical_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 totalDiffuse = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse;
	vec3 totalSpecular = reflectedLight.directSpecular + reflectedLight.indirectSpecular;
	#include <transmission_fragment>
	vec3 outgoingLight = totalDiffuse + totalSpecular + totalEmissiveRadiance;
	#ifdef USE_SHEEN
 
		outgoingLight = outgoingLight + sheenSpecularDirect + sheenSpecularIndirect;
 
 	#endif
	#ifdef USE_CLEARCOAT
		float dotNVcc = saturate( dot( geometryClearcoatNormal, geometryViewDir ) );
		vec3 Fcc = F_Schlick( material.clearcoatF0, material.clearcoatF90, dotNVcc );
		outgoingLight = outgoingLight * ( 1.0 - material.clearcoat * Fcc ) + ( clearcoatSpecularDirect + clearcoatSpecularIndirect ) * material.clearcoat;
	#endif
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Ow=`#define TOON
varying vec3 vViewPosition;
#include <common>
#include <batching_pars_vertex>
#include <uv_pars_vertex>
#include <displacementmap_pars_vertex>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <normal_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <shadowmap_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <normal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <displacementmap_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	vViewPosition = - mvPosition.xyz;
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,kw=`#define TOON
uniform vec3 diffuse;
uniform vec3 emissive;
uniform float opacity;
#include <common>
#include <dithering_pars_fragment>
#include <color_pars_fragment>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <aomap_pars_fragment>
#include <lightmap_pars_fragment>
#include <emissivemap_pars_fragment>
#include <gradientmap_pars_fragment>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <normal_pars_fragment>
#include <lights_toon_pars_fragment>
#include <shadowmap_pars_fragment>
#include <bumpmap_pars_fragment>
#include <normalmap_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	ReflectedLight reflectedLight = ReflectedLight( vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ), vec3( 0.0 ) );
	vec3 totalEmissiveRadiance = emissive;
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <color_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	#include <normal_fragment_begin>
	#include <normal_fragment_maps>
	#include <emissivemap_fragment>
	#include <lights_toon_fragment>
	#include <lights_fragment_begin>
	#include <lights_fragment_maps>
	#include <lights_fragment_end>
	#include <aomap_fragment>
	vec3 outgoingLight = reflectedLight.directDiffuse + reflectedLight.indirectDiffuse + totalEmissiveRadiance;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
	#include <dithering_fragment>
}`,Bw=`uniform float size;
uniform float scale;
#include <common>
#include <color_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
#ifdef USE_POINTS_UV
	varying vec2 vUv;
	uniform mat3 uvTransform;
#endif
void main() {
	#ifdef USE_POINTS_UV
		vUv = ( uvTransform * vec3( uv, 1 ) ).xy;
	#endif
	#include <color_vertex>
	#include <morphinstance_vertex>
	#include <morphcolor_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <project_vertex>
	gl_PointSize = size;
	#ifdef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) gl_PointSize *= ( scale / - mvPosition.z );
	#endif
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <worldpos_vertex>
	#include <fog_vertex>
}`,zw=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <color_pars_fragment>
#include <map_particle_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_particle_fragment>
	#include <color_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,Vw=`#include <common>
#include <batching_pars_vertex>
#include <fog_pars_vertex>
#include <morphtarget_pars_vertex>
#include <skinning_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <shadowmap_pars_vertex>
void main() {
	#include <batching_vertex>
	#include <beginnormal_vertex>
	#include <morphinstance_vertex>
	#include <morphnormal_vertex>
	#include <skinbase_vertex>
	#include <skinnormal_vertex>
	#include <defaultnormal_vertex>
	#include <begin_vertex>
	#include <morphtarget_vertex>
	#include <skinning_vertex>
	#include <project_vertex>
	#include <logdepthbuf_vertex>
	#include <worldpos_vertex>
	#include <shadowmap_vertex>
	#include <fog_vertex>
}`,Hw=`uniform vec3 color;
uniform float opacity;
#include <common>
#include <fog_pars_fragment>
#include <bsdfs>
#include <lights_pars_begin>
#include <logdepthbuf_pars_fragment>
#include <shadowmap_pars_fragment>
#include <shadowmask_pars_fragment>
void main() {
	#include <logdepthbuf_fragment>
	gl_FragColor = vec4( color, opacity * ( 1.0 - getShadowMask() ) );
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
	#include <premultiplied_alpha_fragment>
}`,Gw=`uniform float rotation;
uniform vec2 center;
#include <common>
#include <uv_pars_vertex>
#include <fog_pars_vertex>
#include <logdepthbuf_pars_vertex>
#include <clipping_planes_pars_vertex>
void main() {
	#include <uv_vertex>
	vec4 mvPosition = modelViewMatrix[ 3 ];
	vec2 scale = vec2( length( modelMatrix[ 0 ].xyz ), length( modelMatrix[ 1 ].xyz ) );
	#ifndef USE_SIZEATTENUATION
		bool isPerspective = isPerspectiveMatrix( projectionMatrix );
		if ( isPerspective ) scale *= - mvPosition.z;
	#endif
	vec2 alignedPosition = ( position.xy - ( center - vec2( 0.5 ) ) ) * scale;
	vec2 rotatedPosition;
	rotatedPosition.x = cos( rotation ) * alignedPosition.x - sin( rotation ) * alignedPosition.y;
	rotatedPosition.y = sin( rotation ) * alignedPosition.x + cos( rotation ) * alignedPosition.y;
	mvPosition.xy += rotatedPosition;
	gl_Position = projectionMatrix * mvPosition;
	#include <logdepthbuf_vertex>
	#include <clipping_planes_vertex>
	#include <fog_vertex>
}`,Ww=`uniform vec3 diffuse;
uniform float opacity;
#include <common>
#include <uv_pars_fragment>
#include <map_pars_fragment>
#include <alphamap_pars_fragment>
#include <alphatest_pars_fragment>
#include <alphahash_pars_fragment>
#include <fog_pars_fragment>
#include <logdepthbuf_pars_fragment>
#include <clipping_planes_pars_fragment>
void main() {
	vec4 diffuseColor = vec4( diffuse, opacity );
	#include <clipping_planes_fragment>
	vec3 outgoingLight = vec3( 0.0 );
	#include <logdepthbuf_fragment>
	#include <map_fragment>
	#include <alphamap_fragment>
	#include <alphatest_fragment>
	#include <alphahash_fragment>
	outgoingLight = diffuseColor.rgb;
	#include <opaque_fragment>
	#include <tonemapping_fragment>
	#include <colorspace_fragment>
	#include <fog_fragment>
}`,ft={alphahash_fragment:fM,alphahash_pars_fragment:dM,alphamap_fragment:pM,alphamap_pars_fragment:mM,alphatest_fragment:gM,alphatest_pars_fragment:yM,aomap_fragment:_M,aomap_pars_fragment:xM,batching_pars_vertex:vM,batching_vertex:bM,begin_vertex:MM,beginnormal_vertex:SM,bsdfs:wM,iridescence_fragment:AM,bumpmap_pars_fragment:EM,clipping_planes_fragment:TM,clipping_planes_pars_fragment:CM,clipping_planes_pars_vertex:RM,clipping_planes_vertex:IM,color_fragment:PM,color_pars_fragment:LM,color_pars_vertex:DM,color_vertex:NM,common:UM,defaultnormal_vertex:FM,displacementmap_pars_vertex:OM,displacementmap_vertex:kM,emissivemap_fragment:BM,emissivemap_pars_fragment:zM,colorspace_fragment:VM,colorspace_pars_fragment:HM,envmap_fragment:GM,envmap_common_pars_fragment:WM,envmap_pars_fragment:XM,envmap_pars_vertex:$M,envmap_physical_pars_fragment:iS,envmap_vertex:qM,fog_vertex:YM,fog_pars_vertex:ZM,fog_fragment:KM,fog_pars_fragment:JM,gradientmap_pars_fragment:jM,lightmap_pars_fragment:QM,lights_lambert_fragment:eS,lights_lambert_pars_fragment:tS,lights_pars_begin:nS,lights_toon_fragment:sS,lights_toon_pars_fragment:rS,lights_phong_fragment:oS,lights_phong_pars_fragment:aS,lights_physical_fragment:lS,lights_physical_pars_fragment:cS,lights_fragment_begin:hS,lights_fragment_maps:uS,lights_fragment_end:fS,lightprobes_pars_fragment:dS,logdepthbuf_fragment:pS,logdepthbuf_pars_fragment:mS,logdepthbuf_pars_vertex:gS,logdepthbuf_vertex:yS,map_fragment:_S,map_pars_fragment:xS,map_particle_fragment:vS,map_particle_pars_fragment:bS,metalnessmap_fragment:MS,metalnessmap_pars_fragment:SS,morphinstance_vertex:wS,morphcolor_vertex:AS,morphnormal_vertex:ES,morphtarget_pars_vertex:TS,morphtarget_vertex:CS,normal_fragment_begin:RS,normal_fragment_maps:IS,normal_pars_fragment:PS,normal_pars_vertex:LS,normal_vertex:DS,normalmap_pars_fragment:NS,clearcoat_normal_fragment_begin:US,clearcoat_normal_fragment_maps:FS,clearcoat_pars_fragment:OS,iridescence_pars_fragment:kS,opaque_fragment:BS,packing:zS,premultiplied_alpha_fragment:VS,project_vertex:HS,dithering_fragment:GS,dithering_pars_fragment:WS,roughnessmap_fragment:XS,roughnessmap_pars_fragment:$S,shadowmap_pars_fragment:qS,shadowmap_pars_vertex:YS,shadowmap_vertex:ZS,shadowmask_pars_fragment:KS,skinbase_vertex:JS,skinning_pars_vertex:jS,skinning_vertex:QS,skinnormal_vertex:ew,specularmap_fragment:tw,specularmap_pars_fragment:nw,tonemapping_fragment:iw,tonemapping_pars_fragment:sw,transmission_fragment:rw,transmission_pars_fragment:ow,uv_pars_fragment:aw,uv_pars_vertex:lw,uv_vertex:cw,worldpos_vertex:hw,background_vert:uw,background_frag:fw,backgroundCube_vert:dw,backgroundCube_frag:pw,cube_vert:mw,cube_frag:gw,depth_vert:yw,depth_frag:_w,distance_vert:xw,distance_frag:vw,equirect_vert:bw,equirect_frag:Mw,linedashed_vert:Sw,linedashed_frag:ww,meshbasic_vert:Aw,meshbasic_frag:Ew,meshlambert_vert:Tw,meshlambert_frag:Cw,meshmatcap_vert:Rw,meshmatcap_frag:Iw,meshnormal_vert:Pw,meshnormal_frag:Lw,meshphong_vert:Dw,meshphong_frag:Nw,meshphysical_vert:Uw,meshphysical_frag:Fw,meshtoon_vert:Ow,meshtoon_frag:kw,points_vert:Bw,points_frag:zw,shadow_vert:Vw,shadow_frag:Hw,sprite_vert:Gw,sprite_frag:Ww},Le={common:{diffuse:{value:new dt(16777215)},opacity:{value:1},map:{value:null},mapTransform:{value:new nt},alphaMap:{value:null},alphaMapTransform:{value:new nt},alphaTest:{value:0}},specularmap:{specularMap:{value:null},specularMapTransform:{value:new nt}},envmap:{envMap:{value:null},envMapRotation:{value:new nt},reflectivity:{value:1},ior:{value:1.5},refractionRatio:{value:.98},dfgLUT:{value:null}},aomap:{aoMap:{value:null},aoMapIntensity:{value:1},aoMapTransform:{value:new nt}},lightmap:{lightMap:{value:null},lightMapIntensity:{value:1},lightMapTransform:{value:new nt}},bumpmap:{bumpMap:{value:null},bumpMapTransform:{value:new nt},bumpScale:{value:1}},normalmap:{normalMap:{value:null},normalMapTransform:{value:new nt},normalScale:{value:new qe(1,1)}},displacementmap:{displacementMap:{value:null},displacementMapTransform:{value:new nt},displacementScale:{value:1},displacementBias:{value:0}},emissivemap:{emissiveMap:{value:null},emissiveMapTransform:{value:new nt}},metalnessmap:{metalnessMap:{value:null},metalnessMapTransform:{value:new nt}},roughnessmap:{roughnessMap:{value:null},roughnessMapTransform:{value:new nt}},gradientmap:{gradientMap:{value:null}},fog:{fogDensity:{value:25e-5},fogNear:{value:1},fogFar:{value:2e3},fogColor:{value:new dt(16777215)}},lights:{ambientLightColor:{value:[]},lightProbe:{value:[]},sunLights:{value:[],properties:{direction:{},color:{}}},sunLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},sunShadowMatrix:{value:[]},sunShadowCascade:{value:[]},directionalLights:{value:[],properties:{direction:{},color:{}}},directionalLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},directionalShadowMatrix:{value:[]},spotLights:{value:[],properties:{color:{},position:{},direction:{},distance:{},coneCos:{},penumbraCos:{},decay:{}}},spotLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{}}},spotLightMap:{value:[]},spotLightMatrix:{value:[]},pointLights:{value:[],properties:{color:{},position:{},decay:{},distance:{}}},pointLightShadows:{value:[],properties:{shadowIntensity:1,shadowBias:{},shadowNormalBias:{},shadowRadius:{},shadowMapSize:{},shadowCameraNear:{},shadowCameraFar:{}}},pointShadowMatrix:{value:[]},hemisphereLights:{value:[],properties:{direction:{},skyColor:{},groundColor:{}}},rectAreaLights:{value:[],properties:{color:{},position:{},width:{},height:{}}},ltc_1:{value:null},ltc_2:{value:null},probesSH:{value:[]},probesMin:{value:[]},probesMax:{value:[]},probesResolution:{value:[]}},points:{diffuse:{value:new dt(16777215)},opacity:{value:1},size:{value:1},scale:{value:1},map:{value:null},alphaMap:{value:null},alphaMapTransform:{value:new nt},alphaTest:{value:0},uvTransform:{value:new nt}},sprite:{diffuse:{value:new dt(16777215)},opacity:{value:1},center:{value:new qe(.5,.5)},rotation:{value:0},map:{value:null},mapTransform:{value:new nt},alphaMap:{value:null},alphaMapTransform:{value:new nt},alphaTest:{value:0}}},ys={basic:{uniforms:ei([Le.common,Le.specularmap,Le.envmap,Le.aomap,Le.lightmap,Le.fog]),vertexShader:ft.meshbasic_vert,fragmentShader:ft.meshbasic_frag},lambert:{uniforms:ei([Le.common,Le.specularmap,Le.envmap,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.fog,Le.lights,{emissive:{value:new dt(0)},envMapIntensity:{value:1}}]),vertexShader:ft.meshlambert_vert,fragmentShader:ft.meshlambert_frag},phong:{uniforms:ei([Le.common,Le.specularmap,Le.envmap,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.fog,Le.lights,{emissive:{value:new dt(0)},specular:{value:new dt(1118481)},shininess:{value:30},envMapIntensity:{value:1}}]),vertexShader:ft.meshphong_vert,fragmentShader:ft.meshphong_frag},standard:{uniforms:ei([Le.common,Le.envmap,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.roughnessmap,Le.metalnessmap,Le.fog,Le.lights,{emissive:{value:new dt(0)},roughness:{value:1},metalness:{value:0},envMapIntensity:{value:1}}]),vertexShader:ft.meshphysical_vert,fragmentShader:ft.meshphysical_frag},toon:{uniforms:ei([Le.common,Le.aomap,Le.lightmap,Le.emissivemap,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.gradientmap,Le.fog,Le.lights,{emissive:{value:new dt(0)}}]),vertexShader:ft.meshtoon_vert,fragmentShader:ft.meshtoon_frag},matcap:{uniforms:ei([Le.common,Le.bumpmap,Le.normalmap,Le.displacementmap,Le.fog,{matcap:{value:null}}]),vertexShader:ft.meshmatcap_vert,fragmentShader:ft.meshmatcap_frag},points:{uniforms:ei([Le.points,Le.fog]),vertexShader:ft.points_vert,fragmentShader:ft.points_frag},dashed:{uniforms:ei([Le.common,Le.fog,{scale:{value:1},dashSize:{value:1},totalSize:{value:2}}]),vertexShader:ft.linedashed_vert,fragmentShader:ft.linedashed_frag},depth:{uniforms:ei([Le.common,Le.displacementmap]),vertexShader:ft.depth_vert,fragmentShader:ft.depth_frag},normal:{uniforms:ei([Le.common,Le.bumpmap,Le.normalmap,Le.displacementmap,{opacity:{value:1}}]),vertexShader:ft.meshnormal_vert,fragmentShader:ft.meshnormal_frag},sprite:{uniforms:ei([Le.sprite,Le.fog]),vertexShader:ft.sprite_vert,fragmentShader:ft.sprite_frag},background:{uniforms:{uvTransform:{value:new nt},t2D:{value:null},backgroundIntensity:{value:1}},vertexShader:ft.background_vert,fragmentShader:ft.background_frag},backgroundCube:{uniforms:{envMap:{value:null},backgroundBlurriness:{value:0},backgroundIntensity:{value:1},backgroundRotation:{value:new nt}},vertexShader:ft.backgroundCube_vert,fragmentShader:ft.backgroundCube_frag},cube:{uniforms:{tCube:{value:null},tFlip:{value:-1},opacity:{value:1}},vertexShader:ft.cube_vert,fragmentShader:ft.cube_frag},equirect:{uniforms:{tEquirect:{value:null}},vertexShader:ft.equirect_vert,fragmentShader:ft.equirect_frag},distance:{uniforms:ei([Le.common,Le.displacementmap,{referencePosition:{value:new O},nearDistance:{value:1},farDistance:{value:1e3}}]),vertexShader:ft.distance_vert,fragmentShader:ft.distance_frag},shadow:{uniforms:ei([Le.lights,Le.fog,{color:{value:new dt(0)},opacity:{value:1}}]),vertexShader:ft.shadow_vert,fragmentShader:ft.shadow_frag}};ys.physical={uniforms:ei([ys.standard.uniforms,{clearcoat:{value:0},clearcoatMap:{value:null},clearcoatMapTransform:{value:new nt},clearcoatNormalMap:{value:null},clearcoatNormalMapTransform:{value:new nt},clearcoatNormalScale:{value:new qe(1,1)},clearcoatRoughness:{value:0},clearcoatRoughnessMap:{value:null},clearcoatRoughnessMapTransform:{value:new nt},diffuseRoughness:{value:0},diffuseRoughnessMap:{value:null},diffuseRoughnessMapTransform:{value:new nt},dispersion:{value:0},retroreflectivity:{value:0},iridescence:{value:0},iridescenceMap:{value:null},iridescenceMapTransform:{value:new nt},iridescenceIOR:{value:1.3},iridescenceThicknessMinimum:{value:100},iridescenceThicknessMaximum:{value:400},iridescenceThicknessMap:{value:null},iridescenceThicknessMapTransform:{value:new nt},sheen:{value:0},sheenColor:{value:new dt(0)},sheenColorMap:{value:null},sheenColorMapTransform:{value:new nt},sheenRoughness:{value:1},sheenRoughnessMap:{value:null},sheenRoughnessMapTransform:{value:new nt},transmission:{value:0},transmissionMap:{value:null},transmissionMapTransform:{value:new nt},transmissionSamplerSize:{value:new qe},transmissionSamplerMap:{value:null},thickness:{value:0},thicknessMap:{value:null},thicknessMapTransform:{value:new nt},attenuationDistance:{value:0},attenuationColor:{value:new dt(0)},specularColor:{value:new dt(1,1,1)},specularColorMap:{value:null},specularColorMapTransform:{value:new nt},specularIntensity:{value:1},specularIntensityMap:{value:null},specularIntensityMapTransform:{value:new nt},anisotropyVector:{value:new qe},anisotropyMap:{value:null},anisotropyMapTransform:{value:new nt}}]),vertexShader:ft.meshphysical_vert,fragmentShader:ft.meshphysical_frag};var kh={r:0,b:0,g:0},Xw=new Vt,Q0=new nt;Q0.set(-1,0,0,0,1,0,0,0,1);function $w(i,e,t,n,s,r){let o=new dt(0),a=s===!0?0:1,l,c,h=null,u=0,f=null;function p(y){let w=y.isScene===!0?y.background:null;if(w&&w.isTexture){let v=y.backgroundBlurriness>0;w=e.get(w,v)}return w}function g(y){let w=!1,v=p(y);v===null?m(o,a):v&&v.isColor&&(m(v,1),w=!0);let E=i.xr.getEnvironmentBlendMode();E==="additive"?t.buffers.color.setClear(0,0,0,1,r):E==="alpha-blend"&&t.buffers.color.setClear(0,0,0,0,r),(i.autoClear||w)&&(t.buffers.depth.setTest(!0),t.buffers.depth.setMask(!0),t.buffers.color.setMask(!0),i.clear(i.autoClearColor,i.autoClearDepth,i.autoClearStencil))}function x(y,w){let v=p(w);v&&v.isCubeTexture?(c===void 0&&(c=new _t(new tr(1,1,1),new ps({name:"BackgroundCubeMaterial",uniforms:Or(ys.backgroundCube.uniforms),vertexShader:ys.backgroundCube.vertexShader,fragmentShader:ys.backgroundCube.fragmentShader,side:ui,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),c.geometry.deleteAttribute("normal"),c.geometry.deleteAttribute("uv"),c.onBeforeRender=function(E,S,_){this.matrixWorld.copyPosition(_.matrixWorld)},Object.defineProperty(c.material,"envMap",{get:function(){return this.uniforms.envMap.value}}),n.update(c)),c.material.uniforms.envMap.value=v,c.material.uniforms.backgroundBlurriness.value=w.backgroundBlurriness,c.material.uniforms.backgroundIntensity.value=w.backgroundIntensity,c.material.uniforms.backgroundRotation.value.setFromMatrix4(Xw.makeRotationFromEuler(w.backgroundRotation)).transpose(),v.isRenderTargetTexture===!1&&c.material.uniforms.backgroundRotation.value.premultiply(Q0),c.material.toneMapped=bt.getTransfer(v.colorSpace)!==Dt,(h!==v||u!==v.version||f!==i.toneMapping)&&(c.material.needsUpdate=!0,h=v,u=v.version,f=i.toneMapping),c.layers.enableAll(),y.unshift(c,c.geometry,c.material,0,0,null)):v&&v.isTexture&&(l===void 0&&(l=new _t(new Va(2,2),new ps({name:"BackgroundMaterial",uniforms:Or(ys.background.uniforms),vertexShader:ys.background.vertexShader,fragmentShader:ys.background.fragmentShader,side:cr,depthTest:!1,depthWrite:!1,fog:!1,allowOverride:!1})),l.geometry.deleteAttribute("normal"),Object.defineProperty(l.material,"map",{get:function(){return this.uniforms.t2D.value}}),n.update(l)),l.material.uniforms.t2D.value=v,l.material.uniforms.backgroundIntensity.value=w.backgroundIntensity,l.material.toneMapped=bt.getTransfer(v.colorSpace)!==Dt,v.matrixAutoUpdate===!0&&v.updateMatrix(),l.material.uniforms.uvTransform.value.copy(v.matrix),(h!==v||u!==v.version||f!==i.toneMapping)&&(l.material.needsUpdate=!0,h=v,u=v.version,f=i.toneMapping),l.layers.enableAll(),y.unshift(l,l.geometry,l.material,0,0,null))}function m(y,w){y.getRGB(kh,gd(i)),t.buffers.color.setClear(kh.r,kh.g,kh.b,w,r)}function d(){c!==void 0&&(c.geometry.dispose(),c.material.dispose(),c=void 0),l!==void 0&&(l.geometry.dispose(),l.material.dispose(),l=void 0)}return{getClearColor:function(){return o},setClearColor:function(y,w=1){o.set(y),a=w,m(o,a)},getClearAlpha:function(){return a},setClearAlpha:function(y){a=y,m(o,a)},render:g,addToRenderList:x,dispose:d}}function qw(i,e){let t=i.getParameter(i.MAX_VERTEX_ATTRIBS),n={},s=f(null),r=s,o=!1;function a(L,k,V,R,U){let X=!1,H=u(L,R,V,k);r!==H&&(r=H,c(r.object)),X=p(L,R,V,U),X&&g(L,R,V,U),U!==null&&e.update(U,i.ELEMENT_ARRAY_BUFFER),(X||o)&&(o=!1,v(L,k,V,R),U!==null&&i.bindBuffer(i.ELEMENT_ARRAY_BUFFER,e.get(U).buffer))}function l(){return i.createVertexArray()}function c(L){return i.bindVertexArray(L)}function h(L){return i.deleteVertexArray(L)}function u(L,k,V,R){let U=R.wireframe===!0,X=n[k.id];X===void 0&&(X={},n[k.id]=X);let H=L.isInstancedMesh===!0?L.id:0,ae=X[H];ae===void 0&&(ae={},X[H]=ae);let Y=ae[V.id];Y===void 0&&(Y={},ae[V.id]=Y);let J=Y[U];return J===void 0&&(J=f(l()),Y[U]=J),J}function f(L){let k=[],V=[],R=[];for(let U=0;U<t;U++)k[U]=0,V[U]=0,R[U]=0;return{geometry:null,program:null,wireframe:!1,newAttributes:k,enabledAttributes:V,attributeDivisors:R,object:L,attributes:{},index:null}}function p(L,k,V,R){let U=r.attributes,X=k.attributes,H=0,ae=V.getAttributes();for(let Y in ae)if(ae[Y].location>=0){let ee=U[Y],fe=X[Y];if(fe===void 0&&(Y==="instanceMatrix"&&L.instanceMatrix&&(fe=L.instanceMatrix),Y==="instanceColor"&&L.instanceColor&&(fe=L.instanceColor)),ee===void 0||ee.attribute!==fe||fe&&ee.data!==fe.data)return!0;H++}return r.attributesNum!==H||r.index!==R}function g(L,k,V,R){let U={},X=k.attributes,H=0,ae=V.getAttributes();for(let Y in ae)if(ae[Y].location>=0){let ee=X[Y];ee===void 0&&(Y==="instanceMatrix"&&L.instanceMatrix&&(ee=L.instanceMatrix),Y==="instanceColor"&&L.instanceColor&&(ee=L.instanceColor));let fe={};fe.attribute=ee,ee&&ee.data&&(fe.data=ee.data),U[Y]=fe,H++}r.attributes=U,r.attributesNum=H,r.index=R}function x(){let L=r.newAttributes;for(let k=0,V=L.length;k<V;k++)L[k]=0}function m(L){d(L,0)}function d(L,k){let V=r.newAttributes,R=r.enabledAttributes,U=r.attributeDivisors;V[L]=1,R[L]===0&&(i.enableVertexAttribArray(L),R[L]=1),U[L]!==k&&(i.vertexAttribDivisor(L,k),U[L]=k)}function y(){let L=r.newAttributes,k=r.enabledAttributes;for(let V=0,R=k.length;V<R;V++)k[V]!==L[V]&&(i.disableVertexAttribArray(V),k[V]=0)}function w(L,k,V,R,U,X,H){H===!0?i.vertexAttribIPointer(L,k,V,U,X):i.vertexAttribPointer(L,k,V,R,U,X)}function v(L,k,V,R){x();let U=R.attributes,X=V.getAttributes(),H=k.defaultAttributeValues;for(let ae in X){let Y=X[ae];if(Y.location>=0){let J=U[ae];if(J===void 0&&(ae==="instanceMatrix"&&L.instanceMatrix&&(J=L.instanceMatrix),ae==="instanceColor"&&L.instanceColor&&(J=L.instanceColor)),J!==void 0){let ee=J.normalized,fe=J.itemSize,ue=e.get(J);if(ue===void 0)continue;let Q=ue.buffer,me=ue.type,ge=ue.bytesPerElement,_e=me===i.INT||me===i.UNSIGNED_INT||J.gpuType===th;if(J.isInterleavedBufferAttribute){let ye=J.data,He=ye.isInterleavedBuffer===!0?ye.stride:ye.itemSize,Ke=J.offset;if(ye.isInstancedInterleavedBuffer||ye.isInstancedBufferAttribute){for(let Oe=0;Oe<Y.locationSize;Oe++)d(Y.location+Oe,ye.meshPerAttribute);L.isInstancedMesh!==!0&&R._maxInstanceCount===void 0&&(R._maxInstanceCount=ye.meshPerAttribute*ye.count)}else for(let Oe=0;Oe<Y.locationSize;Oe++)m(Y.location+Oe);i.bindBuffer(i.ARRAY_BUFFER,Q);for(let Oe=0;Oe<Y.locationSize;Oe++)w(Y.location+Oe,fe/Y.locationSize,me,ee,He*ge,(Ke+fe/Y.locationSize*Oe)*ge,_e)}else{if(J.isInstancedBufferAttribute){for(let ye=0;ye<Y.locationSize;ye++)d(Y.location+ye,J.meshPerAttribute);L.isInstancedMesh!==!0&&R._maxInstanceCount===void 0&&(R._maxInstanceCount=J.meshPerAttribute*J.count)}else for(let ye=0;ye<Y.locationSize;ye++)m(Y.location+ye);i.bindBuffer(i.ARRAY_BUFFER,Q);for(let ye=0;ye<Y.locationSize;ye++)w(Y.location+ye,fe/Y.locationSize,me,ee,fe*ge,fe/Y.locationSize*ye*ge,_e)}}else if(H!==void 0){let ee=H[ae];if(ee!==void 0)switch(ee.length){case 2:i.vertexAttrib2fv(Y.location,ee);break;case 3:i.vertexAttrib3fv(Y.location,ee);break;case 4:i.vertexAttrib4fv(Y.location,ee);break;default:i.vertexAttrib1fv(Y.location,ee)}}}}y()}function E(){D();for(let L in n){let k=n[L];for(let V in k){let R=k[V];for(let U in R){let X=R[U];for(let H in X)h(X[H].object),delete X[H];delete R[U]}}delete n[L]}}function S(L){if(n[L.id]===void 0)return;let k=n[L.id];for(let V in k){let R=k[V];for(let U in R){let X=R[U];for(let H in X)h(X[H].object),delete X[H];delete R[U]}}delete n[L.id]}function _(L){for(let k in n){let V=n[k];for(let R in V){let U=V[R];if(U[L.id]===void 0)continue;let X=U[L.id];for(let H in X)h(X[H].object),delete X[H];delete U[L.id]}}}function M(L){for(let k in n){let V=n[k],R=L.isInstancedMesh===!0?L.id:0,U=V[R];if(U!==void 0){for(let X in U){let H=U[X];for(let ae in H)h(H[ae].object),delete H[ae];delete U[X]}delete V[R],Object.keys(V).length===0&&delete n[k]}}}function D(){I(),o=!0,r!==s&&(r=s,c(r.object))}function I(){s.geometry=null,s.program=null,s.wireframe=!1}return{setup:a,reset:D,resetDefaultState:I,dispose:E,releaseStatesOfGeometry:S,releaseStatesOfObject:M,releaseStatesOfProgram:_,initAttributes:x,enableAttribute:m,disableUnusedAttributes:y}}function Yw(i,e,t){let n;function s(l){n=l}function r(l,c){i.drawArrays(n,l,c),t.update(c,n,1)}function o(l,c,h){h!==0&&(i.drawArraysInstanced(n,l,c,h),t.update(c,n,h))}function a(l,c,h){if(h===0)return;e.get("WEBGL_multi_draw").multiDrawArraysWEBGL(n,l,0,c,0,h);let f=0;for(let p=0;p<h;p++)f+=c[p];t.update(f,n,1)}this.setMode=s,this.render=r,this.renderInstances=o,this.renderMultiDraw=a}function Zw(i,e,t,n){let s;function r(){if(s!==void 0)return s;if(e.has("EXT_texture_filter_anisotropic")===!0){let _=e.get("EXT_texture_filter_anisotropic");s=i.getParameter(_.MAX_TEXTURE_MAX_ANISOTROPY_EXT)}else s=0;return s}function o(_){return!(_!==Qi&&n.convert(_)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_FORMAT))}function a(_){let M=_===ji&&(e.has("EXT_color_buffer_half_float")||e.has("EXT_color_buffer_float"));return!(_!==pi&&_!==Ji&&!M&&n.convert(_)!==i.getParameter(i.IMPLEMENTATION_COLOR_READ_TYPE))}function l(_){if(_==="highp"){if(i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.HIGH_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.HIGH_FLOAT).precision>0)return"highp";_="mediump"}return _==="mediump"&&i.getShaderPrecisionFormat(i.VERTEX_SHADER,i.MEDIUM_FLOAT).precision>0&&i.getShaderPrecisionFormat(i.FRAGMENT_SHADER,i.MEDIUM_FLOAT).precision>0?"mediump":"lowp"}let c=t.precision!==void 0?t.precision:"highp",h=l(c);h!==c&&(Ye("WebGLRenderer:",c,"not supported, using",h,"instead."),c=h);let u=t.reversedDepthBuffer===!0&&e.has("EXT_clip_control"),f=t.logarithmicDepthBuffer===!0&&u===!1;t.reversedDepthBuffer===!0&&u===!1&&Ye("WebGLRenderer: Unable to use reversed depth buffer due to missing EXT_clip_control extension. Fallback to default depth buffer."),t.logarithmicDepthBuffer===!0&&u===!0&&Ye("WebGLRenderer: Logarithmic depth buffer is ignored when reversed depth buffer is enabled.");let p=i.getParameter(i.MAX_TEXTURE_IMAGE_UNITS),g=i.getParameter(i.MAX_VERTEX_TEXTURE_IMAGE_UNITS),x=i.getParameter(i.MAX_TEXTURE_SIZE),m=i.getParameter(i.MAX_CUBE_MAP_TEXTURE_SIZE),d=i.getParameter(i.MAX_VERTEX_ATTRIBS),y=i.getParameter(i.MAX_VERTEX_UNIFORM_VECTORS),w=i.getParameter(i.MAX_VARYING_VECTORS),v=i.getParameter(i.MAX_FRAGMENT_UNIFORM_VECTORS),E=i.getParameter(i.MAX_SAMPLES),S=i.getParameter(i.SAMPLES);return{isWebGL2:!0,getMaxAnisotropy:r,getMaxPrecision:l,textureFormatReadable:o,textureTypeReadable:a,precision:c,logarithmicDepthBuffer:f,reversedDepthBuffer:u,maxTextures:p,maxVertexTextures:g,maxTextureSize:x,maxCubemapSize:m,maxAttributes:d,maxVertexUniforms:y,maxVaryings:w,maxFragmentUniforms:v,maxSamples:E,samples:S}}function Kw(i){let e=this,t=null,n=0,s=!1,r=!1,o=new jn,a=new nt,l={value:null,needsUpdate:!1};this.uniform=l,this.numPlanes=0,this.numIntersection=0,this.init=function(u,f){let p=u.length!==0||f||n!==0||s;return s=f,n=u.length,p},this.beginShadows=function(){r=!0,h(null)},this.endShadows=function(){r=!1},this.setGlobalState=function(u,f){t=h(u,f,0)},this.setState=function(u,f,p){let g=u.clippingPlanes,x=u.clipIntersection,m=u.clipShadows,d=i.get(u);if(!s||g===null||g.length===0||r&&!m)r?h(null):c();else{let y=r?0:n,w=y*4,v=d.clippingState||null;l.value=v,v=h(g,f,w,p);for(let E=0;E!==w;++E)v[E]=t[E];d.clippingState=v,this.numIntersection=x?this.numPlanes:0,this.numPlanes+=y}};function c(){l.value!==t&&(l.value=t,l.needsUpdate=n>0),e.numPlanes=n,e.numIntersection=0}function h(u,f,p,g){let x=u!==null?u.length:0,m=null;if(x!==0){if(m=l.value,g!==!0||m===null){let d=p+x*4,y=f.matrixWorldInverse;a.getNormalMatrix(y),(m===null||m.length<d)&&(m=new Float32Array(d));for(let w=0,v=p;w!==x;++w,v+=4)o.copy(u[w]).applyMatrix4(y,a),o.normal.toArray(m,v),m[v+3]=o.constant}l.value=m,l.needsUpdate=!0}return e.numPlanes=x,e.numIntersection=0,m}}var ol=class extends Ci{constructor(e=1,t={}){super(e,e,t),this.isWebGLCubeRenderTarget=!0;let n={width:e,height:e,depth:1},s=[n,n,n,n,n,n];this.texture=new Fa(s),this._setTextureOptions(t),this.texture.isRenderTargetTexture=!0}fromEquirectangularTexture(e,t){this.texture.type=t.type,this.texture.colorSpace=t.colorSpace,this.texture.generateMipmaps=t.generateMipmaps,this.texture.minFilter=t.minFilter,this.texture.magFilter=t.magFilter;let n={uniforms:{tEquirect:{value:null}},vertexShader:`

				varying vec3 vWorldDirection;

				vec3 transformDirection( in vec3 dir, in mat4 matrix ) {

					return normalize( ( matrix * vec4( dir, 0.0 ) ).xyz );

				}

				void main() {

					vWorldDirection = transformDirection( position, modelMatrix );

					#include <begin_vertex>
					#include <project_vertex>

				}
			`,fragmentShader:`

				uniform sampler2D tEquirect;

				varying vec3 vWorldDirection;

				#include <common>

				void main() {

					vec3 direction = normalize( vWorldDirection );

					vec2 sampleUV = equirectUv( direction );

					gl_FragColor = texture2D( tEquirect, sampleUV );

				}
			`},s=new tr(5,5,5),r=new ps({name:"CubemapFromEquirect",uniforms:Or(n.uniforms),vertexShader:n.vertexShader,fragmentShader:n.fragmentShader,side:ui,blending:Dr});r.uniforms.tEquirect.value=t;let o=new _t(s,r),a=t.minFilter;return t.minFilter===Fs&&(t.minFilter=hi),new ko(1,10,this).update(e,o),t.minFilter=a,o.geometry.dispose(),o.material.dispose(),this}clear(e,t=!0,n=!0,s=!0){let r=e.getRenderTarget();for(let o=0;o<6;o++)e.setRenderTarget(this,o),e.clear(t,n,s);e.setRenderTarget(r)}},P0=256,Jw=3,jw=20,ey=256,ty=16,Qw=3,e1=new O,t1=new dt,zh=class i{constructor(e){this._renderer=e,this._cubeSize=0,this._sourceTarget=null,this._cubeCamera=new ko(1,10,null),this._boxMesh=new _t(new tr(5,5,5),null),this._cubemapMaterial=null,this._equirectMaterial=null,this._blurMaterial=null,this._ggxMaterial=null,this._integrationMaterial=null}fromScene(e,t=0,n=.1,s=100,r={}){let{size:o=256,position:a=e1}=r,l=this._renderer;this._setSize(o);let c=this._allocateTarget(),h=this._getSourceTarget(!0);t>0&&(h.texture.mipmapsAutoUpdate=!1);let u=l.autoClear,f=l.autoClearColor,p=l.autoClearDepth,g=l.autoClearStencil,x=e.background;l.autoClear=!0,l.autoClearColor=!0,l.autoClearDepth=!0,l.autoClearStencil=!0,x===null&&(e.background=l.getClearColor(t1));let m=new ko(n,s,h);return m.position.copy(a),m.update(l,e),l.autoClear=u,l.autoClearColor=f,l.autoClearDepth=p,l.autoClearStencil=g,e.background=x,t>0&&(h.texture.mipmapsAutoUpdate=!0,this._blur(c,t)),this._applyPMREM(c),c}fromEquirectangular(e,t=null){return this._fromTexture(e,t)}fromCubemap(e,t=null){return this._fromTexture(e,t)}compileCubemapShader(){this._cubemapMaterial===null&&(this._cubemapMaterial=N0(),this._compileMaterial(this._cubemapMaterial))}compileEquirectangularShader(){this._equirectMaterial===null&&(this._equirectMaterial=D0(),this._compileMaterial(this._equirectMaterial))}dispose(){this._sourceTarget!==null&&this._sourceTarget.dispose(),this._cubemapMaterial!==null&&this._cubemapMaterial.dispose(),this._equirectMaterial!==null&&this._equirectMaterial.dispose(),this._blurMaterial!==null&&this._blurMaterial.dispose(),this._ggxMaterial!==null&&this._ggxMaterial.dispose(),this._integrationMaterial!==null&&this._integrationMaterial.dispose(),this._boxMesh.geometry.dispose()}static lodToRoughness(e,t){return t>0?1-Math.sqrt(1-e/t):0}_setSize(e){this._cubeSize=Math.max(P0,dd(e))}_fromTexture(e,t){e.mapping===Ur||e.mapping===Ho?this._setSize(e.image.length===0?P0:e.image[0].width||e.image[0].image.width):this._setSize(e.image.width/4);let n=t||this._allocateTarget();return this._textureToCubemap(e),this._applyPMREM(n),n}_allocateTarget(){let e=this._cubeSize,t=L0(e,!1,!1),n=Math.log2(e)-Jw;for(let s=0;s<=n;s++)t.texture.mipmaps.push({width:e>>s,height:e>>s});return t.texture.name="PMREM",t.texture.isPMREMTexture=!0,t}_getSourceTarget(e=!1){let t=this._cubeSize,n=this._sourceTarget;return(n===null||n.width!==t||e&&n.depthBuffer===!1)&&(n!==null&&n.dispose(),this._sourceTarget=L0(t,!0,e)),this._sourceTarget}_compileMaterial(e){this._boxMesh.material=e,this._renderer.compile(this._boxMesh,this._cubeCamera.children[0])}_renderCube(e,t,n){let s=this._boxMesh,r=this._cubeCamera;s.material=n,r.renderTarget=e,r.activeMipmapLevel=t;let o=e.width>>t;e.viewport.set(0,0,o,o),r.update(this._renderer,s),e.viewport.set(0,0,e.width,e.height)}_textureToCubemap(e){let t;e.mapping===Ur||e.mapping===Ho?(this._cubemapMaterial===null&&(this._cubemapMaterial=N0()),t=this._cubemapMaterial,t.uniforms.flipEnvMap.value=e.isRenderTargetTexture===!1?-1:1):(this._equirectMaterial===null&&(this._equirectMaterial=D0()),t=this._equirectMaterial),t.uniforms.envMap.value=e,this._renderCube(this._getSourceTarget(),0,t)}_applyPMREM(e){this._ggxMaterial===null&&(this._ggxMaterial=n1(),this._integrationMaterial=i1());let t=this._cubeSize,n=e.texture.mipmaps.length-1,s=this._ggxMaterial.uniforms;s.envMap.value=this._sourceTarget.texture;let r=this._integrationMaterial.uniforms;r.envMap.value=this._sourceTarget.texture,r.sourceLod.value=Math.log2(t/ty);for(let o=0;o<=n;o++){let a=i.lodToRoughness(o,n);if(o>n-Qw)r.roughness.value=a,this._renderCube(e,o,this._integrationMaterial);else{let l=a>0?Math.log2(t)+.5*Math.log2(6/(ey*Math.pow(a,4)))+.5:0;s.roughness.value=a,s.lodBias.value=l,this._renderCube(e,o,this._ggxMaterial)}}}_blur(e,t){this._blurMaterial===null&&(this._blurMaterial=s1());let n=this._blurMaterial,s=n.uniforms,r=this._sourceTarget;s.sigma.value=Math.min(t,Math.PI)/Math.SQRT2,s.envMap.value=r.texture,this._renderCube(e,0,n),s.envMap.value=e.texture,this._renderCube(r,0,n)}};function L0(i,e,t){return new ol(i,{minFilter:Fs,generateMipmaps:e,type:ji,colorSpace:Ra,depthBuffer:t})}function al(i,e,t){return new ps({name:i,uniforms:e,vertexShader:ft.cube_vert,fragmentShader:t,side:ui,blending:Dr,depthTest:!1,depthWrite:!1})}function n1(){return al("PMREMGGXConvolution",{envMap:{value:null},roughness:{value:0},lodBias:{value:0}},`

		#define GGX_SAMPLES ${ey}u

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float lodBias;

		#include <common>

		// Van der Corput radical inverse
		float radicalInverse_VdC( uint bits ) {

			bits = ( bits << 16u ) | ( bits >> 16u );
			bits = ( ( bits & 0x55555555u ) << 1u ) | ( ( bits & 0xAAAAAAAAu ) >> 1u );
			bits = ( ( bits & 0x33333333u ) << 2u ) | ( ( bits & 0xCCCCCCCCu ) >> 2u );
			bits = ( ( bits & 0x0F0F0F0Fu ) << 4u ) | ( ( bits & 0xF0F0F0F0u ) >> 4u );
			bits = ( ( bits & 0x00FF00FFu ) << 8u ) | ( ( bits & 0xFF00FF00u ) >> 8u );
			return float( bits ) * 2.3283064365386963e-10; // / 0x100000000

		}

		// Hammersley sequence
		vec2 hammersley( uint i, uint N ) {

			return vec2( float( i ) / float( N ), radicalInverse_VdC( i ) );

		}

		void main() {

			vec3 N = normalize( vWorldDirection );

			// For very low roughness, just sample the environment directly
			if ( roughness < 0.001 ) {

				gl_FragColor = vec4( textureLod( envMap, N, 0.0 ).rgb, 1.0 );
				return;

			}

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			// Tangent space basis for VNDF sampling
			vec3 up = abs( N.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, N ) );
			vec3 bitangent = cross( N, tangent );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			for ( uint i = 0u; i < GGX_SAMPLES; i ++ ) {

				vec2 Xi = hammersley( i, GGX_SAMPLES );

				// With V = N, sample the reflected direction directly.
				float invQ = 1.0 / ( 1.0 - Xi.x + alpha2 * Xi.x );
				float NdotL = ( 1.0 - Xi.x - alpha2 * Xi.x ) * invQ;

				if ( NdotL > 0.0 ) {

					float phi = 2.0 * PI * Xi.y;
					float sinTheta = 2.0 * alpha * sqrt( Xi.x * ( 1.0 - Xi.x ) ) * invQ;
					vec3 L = N * NdotL + ( tangent * cos( phi ) + bitangent * sin( phi ) ) * sinTheta;

					// Match the source mip to the sample's solid angle. The terms
					// independent of the sample are precomputed in lodBias.
					float d = alpha2 * invQ;
					float lod = max( log2( d ) + lodBias, 0.0 );

					// Weight by NdotL for the split-sum approximation
					prefilteredColor += textureLod( envMap, L, lod ).rgb * NdotL;
					totalWeight += NdotL;

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function i1(){return al("PMREMGGXIntegration",{envMap:{value:null},roughness:{value:0},sourceLod:{value:0},sourceSize:{value:ty}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float roughness;
		uniform float sourceLod;
		uniform int sourceSize;

		void main() {

			vec3 N = normalize( vWorldDirection );

			float alpha = roughness * roughness;
			float alpha2 = alpha * alpha;

			float texelSize = 2.0 / float( sourceSize );

			vec3 prefilteredColor = vec3( 0.0 );
			float totalWeight = 0.0;

			// Pair opposite texels: only the one in N's hemisphere contributes.
			for ( int face = 0; face < 3; face ++ ) {

				for ( int y = 0; y < sourceSize; y ++ ) {

					for ( int x = 0; x < sourceSize; x ++ ) {

						vec2 uv = ( vec2( x, y ) + 0.5 ) * texelSize - 1.0;
						vec3 texelDirection = face == 0 ? vec3( 1.0, uv ) : ( face == 1 ? vec3( uv.x, 1.0, uv.y ) : vec3( uv, 1.0 ) );

						float invDistance = inversesqrt( 1.0 + dot( uv, uv ) );
						float NdotL = dot( N, texelDirection );
						texelDirection *= NdotL < 0.0 ? - 1.0 : 1.0;
						NdotL = abs( NdotL ) * invDistance;

						// With V = N, NdotH squared is ( 1 + NdotL ) / 2. Common factors
						// in the GGX distribution and texel solid angle cancel when normalized.
						float d = 1.0 + alpha2 + ( alpha2 - 1.0 ) * NdotL;
						float weight = NdotL * invDistance * invDistance * invDistance / ( d * d );

						prefilteredColor += textureLod( envMap, texelDirection, sourceLod ).rgb * weight;
						totalWeight += weight;

					}

				}

			}

			gl_FragColor = vec4( prefilteredColor / totalWeight, 1.0 );

		}
	`)}function s1(){return al("PMREMSphericalGaussianBlur",{envMap:{value:null},sigma:{value:0}},`

		#define SAMPLES ${jw}
		#define GOLDEN_ANGLE 2.39996322973

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float sigma;

		#include <common>

		void main() {

			vec3 outputDirection = normalize( vWorldDirection );

			vec3 up = abs( outputDirection.z ) < 0.999 ? vec3( 0.0, 0.0, 1.0 ) : vec3( 1.0, 0.0, 0.0 );
			vec3 tangent = normalize( cross( up, outputDirection ) );
			vec3 bitangent = cross( outputDirection, tangent );

			// Truncate the kernel at three standard deviations or at the antipode.
			float thetaMax = min( 3.0 * sigma, PI );
			float truncation = 1.0 - exp( - 0.5 * thetaMax * thetaMax / ( sigma * sigma ) );

			vec3 accumColor = vec3( 0.0 );
			float accumWeight = 0.0;

			for ( int i = 0; i < SAMPLES; i ++ ) {

				// Stratified inverse-CDF sampling of the Gaussian, placed on a golden-angle spiral.
				float stratum = ( float( i ) + 0.5 ) / float( SAMPLES );
				float theta = sigma * sqrt( - 2.0 * log( 1.0 - stratum * truncation ) );
				float phi = float( i ) * GOLDEN_ANGLE;

				vec3 offset = cos( phi ) * tangent + sin( phi ) * bitangent;
				vec3 sampleDirection = cos( theta ) * outputDirection + sin( theta ) * offset;

				// Correct the planar sample density to solid angle.
				float weight = sin( theta ) / theta;

				accumColor += weight * textureLod( envMap, sampleDirection, 0.0 ).rgb;
				accumWeight += weight;

			}

			gl_FragColor = vec4( accumColor / accumWeight, 1.0 );

		}
	`)}function D0(){return al("PMREMEquirectangularToCubemap",{envMap:{value:null}},`

		varying vec3 vWorldDirection;

		uniform sampler2D envMap;

		#include <common>

		void main() {

			// Average four subpixel samples to preserve small, bright features.
			vec3 direction = normalize( vWorldDirection );
			vec3 dx = dFdx( direction ) * 0.25;
			vec3 dy = dFdy( direction ) * 0.25;

			vec3 color = textureLod( envMap, equirectUv( normalize( direction - dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx - dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction - dx + dy ) ), 0.0 ).rgb;
			color += textureLod( envMap, equirectUv( normalize( direction + dx + dy ) ), 0.0 ).rgb;
			gl_FragColor = vec4( color * 0.25, 1.0 );

		}
	`)}function N0(){return al("PMREMCubemapToCubemap",{envMap:{value:null},flipEnvMap:{value:-1}},`

		varying vec3 vWorldDirection;

		uniform samplerCube envMap;
		uniform float flipEnvMap;

		void main() {

			gl_FragColor = vec4( textureCube( envMap, vec3( flipEnvMap * vWorldDirection.x, vWorldDirection.yz ) ).rgb, 1.0 );

		}
	`)}function r1(i){let e=new WeakMap,t=new WeakMap,n=null;function s(f,p=!1){return f==null?null:p?o(f):r(f)}function r(f){if(f&&f.isTexture){let p=f.mapping;if(p===jc||p===Qc)if(e.has(f)){let g=e.get(f).texture;return a(g,f.mapping)}else{let g=f.image;if(g&&g.height>0){let x=new ol(g.height);return x.fromEquirectangularTexture(i,f),e.set(f,x),f.addEventListener("dispose",c),a(x.texture,f.mapping)}else return null}}return f}function o(f){if(f&&f.isTexture&&f.isPMREMTexture!==!0){let p=f.mapping,g=p===jc||p===Qc,x=p===Ur||p===Ho;if(g||x){let m=t.get(f),d=m!==void 0?m.texture.pmremVersion:0;if(f.isRenderTargetTexture&&f.pmremVersion!==d)return n===null&&(n=new zh(i)),m=g?n.fromEquirectangular(f,m):n.fromCubemap(f,m),m.texture.pmremVersion=f.pmremVersion,t.set(f,m),m.texture;if(m!==void 0)return m.texture;{let y=f.image;return g&&y&&y.height>0||x&&y&&l(y)?(n===null&&(n=new zh(i)),m=g?n.fromEquirectangular(f):n.fromCubemap(f),m.texture.pmremVersion=f.pmremVersion,t.set(f,m),f.addEventListener("dispose",h),m.texture):null}}}return f}function a(f,p){return p===jc?f.mapping=Ur:p===Qc&&(f.mapping=Ho),f}function l(f){let p=0,g=6;for(let x=0;x<g;x++)f[x]!==void 0&&p++;return p===g}function c(f){let p=f.target;p.removeEventListener("dispose",c);let g=e.get(p);g!==void 0&&(e.delete(p),g.dispose())}function h(f){let p=f.target;p.removeEventListener("dispose",h);let g=t.get(p);g!==void 0&&(t.delete(p),g.dispose())}function u(){e=new WeakMap,t=new WeakMap,n!==null&&(n.dispose(),n=null)}return{get:s,dispose:u}}function o1(i){let e={};function t(n){if(e[n]!==void 0)return e[n];let s=i.getExtension(n);return e[n]=s,s}return{has:function(n){return t(n)!==null},init:function(){t("EXT_color_buffer_float"),t("WEBGL_clip_cull_distance"),t("OES_texture_float_linear"),t("EXT_color_buffer_half_float"),t("WEBGL_multisampled_render_to_texture"),t("WEBGL_render_shared_exponent")},get:function(n){let s=t(n);return s===null&&Ea("WebGLRenderer: "+n+" extension not supported."),s}}}function a1(i,e,t,n){let s={},r=new WeakMap,o=new FinalizationRegistry(g=>delete s[g]);function a(g){l(g.target)}function l(g){g.index!==null&&e.remove(g.index);for(let m in g.attributes)e.remove(g.attributes[m]);g.removeEventListener("dispose",a),delete s[g.id],o.unregister(g);let x=r.get(g);x&&(e.remove(x),r.delete(g)),n.releaseStatesOfGeometry(g),g.isInstancedBufferGeometry===!0&&delete g._maxInstanceCount,t.memory.geometries--}function c(g,x){return s[x.id]!==void 0||(x.addEventListener("dispose",a),s[x.id]=new WeakRef(x),o.register(x,x.id,x),t.memory.geometries++),x}function h(g){let x=g.attributes;for(let m in x)e.update(x[m],i.ARRAY_BUFFER)}function u(g){let x=g.index,m=g.attributes.position,d=0;if(m===void 0)return;let y=x!==null?x.array.length:m.array.length/3-1,w=m.count>=65535?Ua:Na,v=new w(Math.ceil(y/3)*6,1),E=v.array;if(x!==null){let _=x.array;d=x.version;for(let M=0,D=0;M<y;M+=3){let I=_[M+0],L=_[M+1],k=_[M+2];E[D++]=I,E[D++]=L,E[D++]=L,E[D++]=k,E[D++]=k,E[D++]=I}}else{d=m.version;for(let _=0,M=0;_<y;_+=3){let D=_+0,I=_+1,L=_+2;E[M++]=D,E[M++]=I,E[M++]=I,E[M++]=L,E[M++]=L,E[M++]=D}}v.version=d;let S=r.get(g);S&&e.remove(S),r.set(g,v)}function f(g){let x=r.get(g);if(x){let m=g.index;m!==null&&x.version<m.version&&u(g)}else u(g);return r.get(g)}function p(){for(let g in s){let x=s[g].deref();x!==void 0&&l(x)}}return{get:c,update:h,getWireframeAttribute:f,dispose:p}}function l1(i,e,t){let n;function s(u){n=u}let r,o;function a(u){r=u.type,o=u.bytesPerElement}function l(u,f){i.drawElements(n,f,r,u*o),t.update(f,n,1)}function c(u,f,p){p!==0&&(i.drawElementsInstanced(n,f,r,u*o,p),t.update(f,n,p))}function h(u,f,p){if(p===0)return;e.get("WEBGL_multi_draw").multiDrawElementsWEBGL(n,f,0,r,u,0,p);let x=0;for(let m=0;m<p;m++)x+=f[m];t.update(x,n,1)}this.setMode=s,this.setIndex=a,this.render=l,this.renderInstances=c,this.renderMultiDraw=h}function c1(i){let e={geometries:0,textures:0},t={frame:0,calls:0,triangles:0,points:0,lines:0};function n(r,o,a){switch(t.calls++,o){case i.TRIANGLES:t.triangles+=a*(r/3);break;case i.LINES:t.lines+=a*(r/2);break;case i.LINE_STRIP:t.lines+=a*(r-1);break;case i.LINE_LOOP:t.lines+=a*r;break;case i.POINTS:t.points+=a*r;break;default:et("WebGLInfo: Unknown draw mode:",o);break}}function s(){t.calls=0,t.triangles=0,t.points=0,t.lines=0}return{memory:e,render:t,programs:null,autoReset:!0,reset:s,update:n}}function h1(i,e,t){let n=new WeakMap,s=new nn;function r(o,a,l){let c=o.morphTargetInfluences,h=a.morphAttributes.position||a.morphAttributes.normal||a.morphAttributes.color,u=h!==void 0?h.length:0,f=n.get(a);if(f===void 0||f.count!==u){let D=function(){_.dispose(),n.delete(a),a.removeEventListener("dispose",D)};f!==void 0&&f.texture.dispose();let p=a.morphAttributes.position!==void 0,g=a.morphAttributes.normal!==void 0,x=a.morphAttributes.color!==void 0,m=a.morphAttributes.position||[],d=a.morphAttributes.normal||[],y=a.morphAttributes.color||[],w=0;p===!0&&(w=1),g===!0&&(w=2),x===!0&&(w=3);let v=a.attributes.position.count*w,E=1;v>e.maxTextureSize&&(E=Math.ceil(v/e.maxTextureSize),v=e.maxTextureSize);let S=new Float32Array(v*E*4*u),_=new La(S,v,E,u);_.type=Ji,_.needsUpdate=!0;let M=w*4;for(let I=0;I<u;I++){let L=m[I],k=d[I],V=y[I],R=v*E*4*I;for(let U=0;U<L.count;U++){let X=U*M;p===!0&&(s.fromBufferAttribute(L,U),S[R+X+0]=s.x,S[R+X+1]=s.y,S[R+X+2]=s.z,S[R+X+3]=0),g===!0&&(s.fromBufferAttribute(k,U),S[R+X+4]=s.x,S[R+X+5]=s.y,S[R+X+6]=s.z,S[R+X+7]=0),x===!0&&(s.fromBufferAttribute(V,U),S[R+X+8]=s.x,S[R+X+9]=s.y,S[R+X+10]=s.z,S[R+X+11]=V.itemSize===4?s.w:1)}}f={count:u,texture:_,size:new qe(v,E)},n.set(a,f),a.addEventListener("dispose",D)}if(o.isInstancedMesh===!0&&o.morphTexture!==null)l.getUniforms().setValue(i,"morphTexture",o.morphTexture,t);else{let p=0;for(let x=0;x<c.length;x++)p+=c[x];let g=a.morphTargetsRelative?1:1-p;l.getUniforms().setValue(i,"morphTargetBaseInfluence",g),l.getUniforms().setValue(i,"morphTargetInfluences",c)}l.getUniforms().setValue(i,"morphTargetsTexture",f.texture,t),l.getUniforms().setValue(i,"morphTargetsTextureSize",f.size)}return{update:r}}function u1(i,e,t,n,s){let r=new WeakMap;function o(c){let h=s.render.frame,u=c.geometry,f=e.get(c,u);if(r.get(f)!==h&&(e.update(f),r.set(f,h)),c.isInstancedMesh&&(c.hasEventListener("dispose",l)===!1&&c.addEventListener("dispose",l),r.get(c)!==h&&(t.update(c.instanceMatrix,i.ARRAY_BUFFER),c.instanceColor!==null&&t.update(c.instanceColor,i.ARRAY_BUFFER),r.set(c,h))),c.isSkinnedMesh){let p=c.skeleton;r.get(p)!==h&&(p.update(),r.set(p,h))}return f}function a(){r=new WeakMap}function l(c){let h=c.target;h.removeEventListener("dispose",l),n.releaseStatesOfObject(h),t.remove(h.instanceMatrix),h.instanceColor!==null&&t.remove(h.instanceColor)}return{update:o,dispose:a}}var f1={[$f]:"LINEAR_TONE_MAPPING",[qf]:"REINHARD_TONE_MAPPING",[Yf]:"CINEON_TONE_MAPPING",[Zf]:"ACES_FILMIC_TONE_MAPPING",[Jf]:"AGX_TONE_MAPPING",[jf]:"NEUTRAL_TONE_MAPPING",[Kf]:"CUSTOM_TONE_MAPPING"};function d1(i,e,t,n,s,r){let o=new Ci(e,t,{type:i,depthBuffer:s,stencilBuffer:r,samples:n?4:0,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,resolveDepthBuffer:!1,resolveStencilBuffer:!1}),a=null,l=null,c=null,h=new ct;h.setAttribute("position",new Nt([-1,3,0,-1,-1,0,3,-1,0],3)),h.setAttribute("uv",new Nt([0,2,0,0,2,0],2));let u=new Fc({uniforms:{tDiffuse:{value:null}},vertexShader:`
			precision highp float;

			uniform mat4 modelViewMatrix;
			uniform mat4 projectionMatrix;

			attribute vec3 position;
			attribute vec2 uv;

			varying vec2 vUv;

			void main() {
				vUv = uv;
				gl_Position = projectionMatrix * modelViewMatrix * vec4( position, 1.0 );
			}`,fragmentShader:`
			precision highp float;

			uniform sampler2D tDiffuse;

			varying vec2 vUv;

			#include <tonemapping_pars_fragment>
			#include <colorspace_pars_fragment>

			void main() {
				gl_FragColor = texture2D( tDiffuse, vUv );

				#ifdef LINEAR_TONE_MAPPING
					gl_FragColor.rgb = LinearToneMapping( gl_FragColor.rgb );
				#elif defined( REINHARD_TONE_MAPPING )
					gl_FragColor.rgb = ReinhardToneMapping( gl_FragColor.rgb );
				#elif defined( CINEON_TONE_MAPPING )
					gl_FragColor.rgb = CineonToneMapping( gl_FragColor.rgb );
				#elif defined( ACES_FILMIC_TONE_MAPPING )
					gl_FragColor.rgb = ACESFilmicToneMapping( gl_FragColor.rgb );
				#elif defined( AGX_TONE_MAPPING )
					gl_FragColor.rgb = AgXToneMapping( gl_FragColor.rgb );
				#elif defined( NEUTRAL_TONE_MAPPING )
					gl_FragColor.rgb = NeutralToneMapping( gl_FragColor.rgb );
				#elif defined( CUSTOM_TONE_MAPPING )
					gl_FragColor.rgb = CustomToneMapping( gl_FragColor.rgb );
				#endif

				#ifdef SRGB_TRANSFER
					gl_FragColor = sRGBTransferOETF( gl_FragColor );
				#endif
			}`,depthTest:!1,depthWrite:!1}),f=new _t(h,u),p=new Xa(-1,1,1,-1,0,1),g=null,x=null,m=!1,d,y=null,w=[],v=!1;this.setSize=function(E,S){o.setSize(E,S),a!==null&&a.setSize(E,S),l!==null&&l.setSize(E,S);for(let _=0;_<w.length;_++){let M=w[_];M.setSize&&M.setSize(E,S)}},this.setEffects=function(E){w=E,v=w.length>0&&w[0].isRenderPass===!0;let S=o.width,_=o.height;w.length>0&&a===null&&(a=new Ci(S,_,{type:ji,depthBuffer:!1,stencilBuffer:!1}),l=new Ci(S,_,{type:ji,depthBuffer:!1,stencilBuffer:!1}));let M=s===!0&&w.some(D=>D.needsDepthTexture===!0);M!==(o.depthTexture!==null)&&(M===!0&&c===null&&(c=new Us(S,_),r===!0&&(c.format=Os,c.type=Fr)),o.dispose(),o.depthTexture=M?c:null,o.resolveDepthBuffer=M,o.storeMultisampledDepthBuffer=M);for(let D=0;D<w.length;D++){let I=w[D];I.setSize&&I.setSize(S,_),M&&I.needsDepthTexture===!0&&I.setDepthTexture&&I.setDepthTexture(c)}},this.begin=function(E,S){if(m||E.toneMapping===ms&&w.length===0)return!1;if(y=S,S!==null){let _=S.width,M=S.height;(o.width!==_||o.height!==M)&&this.setSize(_,M)}return v===!1&&E.setRenderTarget(o),d=E.toneMapping,E.toneMapping=ms,!0},this.hasRenderPass=function(){return v},this.end=function(E,S){E.toneMapping=d,m=!0;let _=o,M=a;for(let D=0;D<w.length;D++){let I=w[D];I.enabled!==!1&&(I.render(E,M,_,S),I.needsSwap!==!1&&(_=M,M=M===a?l:a))}if(g!==E.outputColorSpace||x!==E.toneMapping){g=E.outputColorSpace,x=E.toneMapping,u.defines={},bt.getTransfer(g)===Dt&&(u.defines.SRGB_TRANSFER="");let D=f1[x];D&&(u.defines[D]=""),u.needsUpdate=!0}u.uniforms.tDiffuse.value=_.texture,E.setRenderTarget(y),E.render(f,p),y=null,m=!1},this.isCompositing=function(){return m},this.dispose=function(){o.dispose(),a!==null&&a.dispose(),l!==null&&l.dispose(),h.dispose(),u.dispose()}}var ny=new fi,iy=new Us(1,1),sy=new Oa(1),ry=new La,oy=new Rc,ay=new Fa,U0=[],F0=[],O0=new Float32Array(16),k0=new Float32Array(9),B0=new Float32Array(4);function qo(i,e,t){let n=i[0];if(n<=0||n>0)return i;let s=e*t,r=U0[s];if(r===void 0&&(r=new Float32Array(s),U0[s]=r),e!==0){n.toArray(r,0);for(let o=1,a=0;o!==e;++o)a+=t,i[o].toArray(r,a)}return r}function In(i,e){if(i.length!==e.length)return!1;for(let t=0,n=i.length;t<n;t++)if(i[t]!==e[t])return!1;return!0}function Pn(i,e){for(let t=0,n=e.length;t<n;t++)i[t]=e[t]}function Hh(i,e){let t=F0[e];t===void 0&&(t=new Int32Array(e),F0[e]=t);for(let n=0;n!==e;++n)t[n]=i.allocateTextureUnit();return t}function p1(i,e){let t=this.cache;t[0]!==e&&(i.uniform1f(this.addr,e),t[0]=e)}function m1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(i.uniform2f(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(In(t,e))return;i.uniform2fv(this.addr,e),Pn(t,e)}}function g1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(i.uniform3f(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else if(e.r!==void 0)(t[0]!==e.r||t[1]!==e.g||t[2]!==e.b)&&(i.uniform3f(this.addr,e.r,e.g,e.b),t[0]=e.r,t[1]=e.g,t[2]=e.b);else{if(In(t,e))return;i.uniform3fv(this.addr,e),Pn(t,e)}}function y1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(i.uniform4f(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(In(t,e))return;i.uniform4fv(this.addr,e),Pn(t,e)}}function _1(i,e){let t=this.cache,n=e.elements;if(n===void 0){if(In(t,e))return;i.uniformMatrix2fv(this.addr,!1,e),Pn(t,e)}else{if(In(t,n))return;B0.set(n),i.uniformMatrix2fv(this.addr,!1,B0),Pn(t,n)}}function x1(i,e){let t=this.cache,n=e.elements;if(n===void 0){if(In(t,e))return;i.uniformMatrix3fv(this.addr,!1,e),Pn(t,e)}else{if(In(t,n))return;k0.set(n),i.uniformMatrix3fv(this.addr,!1,k0),Pn(t,n)}}function v1(i,e){let t=this.cache,n=e.elements;if(n===void 0){if(In(t,e))return;i.uniformMatrix4fv(this.addr,!1,e),Pn(t,e)}else{if(In(t,n))return;O0.set(n),i.uniformMatrix4fv(this.addr,!1,O0),Pn(t,n)}}function b1(i,e){let t=this.cache;t[0]!==e&&(i.uniform1i(this.addr,e),t[0]=e)}function M1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(i.uniform2i(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(In(t,e))return;i.uniform2iv(this.addr,e),Pn(t,e)}}function S1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(i.uniform3i(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(In(t,e))return;i.uniform3iv(this.addr,e),Pn(t,e)}}function w1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(i.uniform4i(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(In(t,e))return;i.uniform4iv(this.addr,e),Pn(t,e)}}function A1(i,e){let t=this.cache;t[0]!==e&&(i.uniform1ui(this.addr,e),t[0]=e)}function E1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y)&&(i.uniform2ui(this.addr,e.x,e.y),t[0]=e.x,t[1]=e.y);else{if(In(t,e))return;i.uniform2uiv(this.addr,e),Pn(t,e)}}function T1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z)&&(i.uniform3ui(this.addr,e.x,e.y,e.z),t[0]=e.x,t[1]=e.y,t[2]=e.z);else{if(In(t,e))return;i.uniform3uiv(this.addr,e),Pn(t,e)}}function C1(i,e){let t=this.cache;if(e.x!==void 0)(t[0]!==e.x||t[1]!==e.y||t[2]!==e.z||t[3]!==e.w)&&(i.uniform4ui(this.addr,e.x,e.y,e.z,e.w),t[0]=e.x,t[1]=e.y,t[2]=e.z,t[3]=e.w);else{if(In(t,e))return;i.uniform4uiv(this.addr,e),Pn(t,e)}}function Gh(i){return i.version===0&&(i.compareFunction=cd,i.needsUpdate=!0),i}function R1(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_2D_SHADOW?r=Gh(iy):r=ny,t.setTexture2D(e||r,s)}function I1(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),t.setTexture3D(e||oy,s)}function P1(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s);let r;this.type===i.SAMPLER_CUBE_SHADOW?r=Gh(sy):r=ay,t.setTextureCube(e||r,s)}function L1(i,e,t){let n=this.cache,s=t.allocateTextureUnit();n[0]!==s&&(i.uniform1i(this.addr,s),n[0]=s),t.setTexture2DArray(e||ry,s)}function D1(i){switch(i){case 5126:return p1;case 35664:return m1;case 35665:return g1;case 35666:return y1;case 35674:return _1;case 35675:return x1;case 35676:return v1;case 5124:case 35670:return b1;case 35667:case 35671:return M1;case 35668:case 35672:return S1;case 35669:case 35673:return w1;case 5125:return A1;case 36294:return E1;case 36295:return T1;case 36296:return C1;case 35678:case 36198:case 36298:case 36306:case 35682:return R1;case 35679:case 36299:case 36307:return I1;case 35680:case 36300:case 36308:case 36293:return P1;case 36289:case 36303:case 36311:case 36292:return L1}}function N1(i,e){i.uniform1fv(this.addr,e)}function U1(i,e){let t=qo(e,this.size,2);i.uniform2fv(this.addr,t)}function F1(i,e){let t=qo(e,this.size,3);i.uniform3fv(this.addr,t)}function O1(i,e){let t=qo(e,this.size,4);i.uniform4fv(this.addr,t)}function k1(i,e){let t=qo(e,this.size,4);i.uniformMatrix2fv(this.addr,!1,t)}function B1(i,e){let t=qo(e,this.size,9);i.uniformMatrix3fv(this.addr,!1,t)}function z1(i,e){let t=qo(e,this.size,16);i.uniformMatrix4fv(this.addr,!1,t)}function V1(i,e){i.uniform1iv(this.addr,e)}function H1(i,e){i.uniform2iv(this.addr,e)}function G1(i,e){i.uniform3iv(this.addr,e)}function W1(i,e){i.uniform4iv(this.addr,e)}function X1(i,e){i.uniform1uiv(this.addr,e)}function $1(i,e){i.uniform2uiv(this.addr,e)}function q1(i,e){i.uniform3uiv(this.addr,e)}function Y1(i,e){i.uniform4uiv(this.addr,e)}function Z1(i,e,t){let n=this.cache,s=e.length,r=Hh(t,s);In(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));let o;this.type===i.SAMPLER_2D_SHADOW?o=Gh(iy):o=ny;for(let a=0;a!==s;++a)t.setTexture2D(e[a]||o,r[a])}function K1(i,e,t){let n=this.cache,s=e.length,r=Hh(t,s);In(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));for(let o=0;o!==s;++o)t.setTexture3D(e[o]||oy,r[o])}function J1(i,e,t){let n=this.cache,s=e.length,r=Hh(t,s);In(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));let o;this.type===i.SAMPLER_CUBE_SHADOW?o=Gh(sy):o=ay;for(let a=0;a!==s;++a)t.setTextureCube(e[a]||o,r[a])}function j1(i,e,t){let n=this.cache,s=e.length,r=Hh(t,s);In(n,r)||(i.uniform1iv(this.addr,r),Pn(n,r));for(let o=0;o!==s;++o)t.setTexture2DArray(e[o]||ry,r[o])}function Q1(i){switch(i){case 5126:return N1;case 35664:return U1;case 35665:return F1;case 35666:return O1;case 35674:return k1;case 35675:return B1;case 35676:return z1;case 5124:case 35670:return V1;case 35667:case 35671:return H1;case 35668:case 35672:return G1;case 35669:case 35673:return W1;case 5125:return X1;case 36294:return $1;case 36295:return q1;case 36296:return Y1;case 35678:case 36198:case 36298:case 36306:case 35682:return Z1;case 35679:case 36299:case 36307:return K1;case 35680:case 36300:case 36308:case 36293:return J1;case 36289:case 36303:case 36311:case 36292:return j1}}var Md=class{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.setValue=D1(t.type)}},Sd=class{constructor(e,t,n){this.id=e,this.addr=n,this.cache=[],this.type=t.type,this.size=t.size,this.setValue=Q1(t.type)}},wd=class{constructor(e){this.id=e,this.seq=[],this.map={}}setValue(e,t,n){let s=this.seq;for(let r=0,o=s.length;r!==o;++r){let a=s[r];a.setValue(e,t[a.id],n)}}},vd=/(\w+)(\])?(\[|\.)?/g;function z0(i,e){i.seq.push(e),i.map[e.id]=e}function eA(i,e,t){let n=i.name,s=n.length;for(vd.lastIndex=0;;){let r=vd.exec(n),o=vd.lastIndex,a=r[1],l=r[2]==="]",c=r[3];if(l&&(a=a|0),c===void 0||c==="["&&o+2===s){z0(t,c===void 0?new Md(a,i,e):new Sd(a,i,e));break}else{let u=t.map[a];u===void 0&&(u=new wd(a),z0(t,u)),t=u}}}var $o=class{constructor(e,t){this.seq=[],this.map={};let n=e.getProgramParameter(t,e.ACTIVE_UNIFORMS);for(let o=0;o<n;++o){let a=e.getActiveUniform(t,o),l=e.getUniformLocation(t,a.name);eA(a,l,this)}let s=[],r=[];for(let o of this.seq)o.type===e.SAMPLER_2D_SHADOW||o.type===e.SAMPLER_CUBE_SHADOW||o.type===e.SAMPLER_2D_ARRAY_SHADOW?s.push(o):r.push(o);s.length>0&&(this.seq=s.concat(r))}setValue(e,t,n,s){let r=this.map[t];r!==void 0&&r.setValue(e,n,s)}setOptional(e,t,n){let s=t[n];s!==void 0&&this.setValue(e,n,s)}static upload(e,t,n,s){for(let r=0,o=t.length;r!==o;++r){let a=t[r],l=n[a.id];l.needsUpdate!==!1&&a.setValue(e,l.value,s)}}static seqWithValue(e,t){let n=[];for(let s=0,r=e.length;s!==r;++s){let o=e[s];o.id in t&&n.push(o)}return n}};function V0(i,e,t){let n=i.createShader(e);return i.shaderSource(n,t),i.compileShader(n),n}var tA=37297,nA=0;function iA(i,e){let t=i.split(`
`),n=[],s=Math.max(e-6,0),r=Math.min(e+6,t.length);for(let o=s;o<r;o++){let a=o+1;n.push(`${a===e?">":" "} ${a}: ${t[o]}`)}return n.join(`
`)}var H0=new nt;function sA(i){bt._getMatrix(H0,bt.workingColorSpace,i);let e=`mat3( ${H0.elements.map(t=>t.toFixed(4))} )`;switch(bt.getTransfer(i)){case Ia:return[e,"LinearTransferOETF"];case Dt:return[e,"sRGBTransferOETF"];default:return Ye("WebGLProgram: Unsupported color space: ",i),[e,"LinearTransferOETF"]}}function G0(i,e,t){let n=i.getShaderParameter(e,i.COMPILE_STATUS),r=(i.getShaderInfoLog(e)||"").trim();if(n&&r==="")return"";let o=/ERROR: 0:(\d+)/.exec(r);if(o){let a=parseInt(o[1]);return t.toUpperCase()+`

`+r+`

`+iA(i.getShaderSource(e),a)}else return r}function rA(i,e){let t=sA(e);return[`vec4 ${i}( vec4 value ) {`,`	return ${t[1]}( vec4( ${t[0]} * value.rgb, value.a ) );`,"}"].join(`
`)}var oA={[$f]:"Linear",[qf]:"Reinhard",[Yf]:"Cineon",[Zf]:"ACESFilmic",[Jf]:"AgX",[jf]:"Neutral",[Kf]:"Custom"};function aA(i,e){let t=oA[e];return t===void 0?(Ye("WebGLProgram: Unsupported toneMapping:",e),"vec3 "+i+"( vec3 color ) { return LinearToneMapping( color ); }"):"vec3 "+i+"( vec3 color ) { return "+t+"ToneMapping( color ); }"}var Bh=new O;function lA(){bt.getLuminanceCoefficients(Bh);let i=Bh.x.toFixed(4),e=Bh.y.toFixed(4),t=Bh.z.toFixed(4);return["float luminance( const in vec3 rgb ) {",`	const vec3 weights = vec3( ${i}, ${e}, ${t} );`,"	return dot( weights, rgb );","}"].join(`
`)}function cA(i){return[i.extensionClipCullDistance?"#extension GL_ANGLE_clip_cull_distance : require":"",i.extensionMultiDraw?"#extension GL_ANGLE_multi_draw : require":""].filter(rl).join(`
`)}function hA(i){let e=[];for(let t in i){let n=i[t];n!==!1&&e.push("#define "+t+" "+n)}return e.join(`
`)}function uA(i,e){let t={},n=i.getProgramParameter(e,i.ACTIVE_ATTRIBUTES);for(let s=0;s<n;s++){let r=i.getActiveAttrib(e,s),o=r.name,a=1;r.type===i.FLOAT_MAT2&&(a=2),r.type===i.FLOAT_MAT3&&(a=3),r.type===i.FLOAT_MAT4&&(a=4),t[o]={type:r.type,location:i.getAttribLocation(e,o),locationSize:a}}return t}function rl(i){return i!==""}function W0(i,e){let t=e.numSpotLightShadows+e.numSpotLightMaps-e.numSpotLightShadowsWithMaps;return i.replace(/NUM_SUN_LIGHTS/g,e.numSunLights).replace(/NUM_DIR_LIGHTS/g,e.numDirLights).replace(/NUM_SPOT_LIGHTS/g,e.numSpotLights).replace(/NUM_SPOT_LIGHT_MAPS/g,e.numSpotLightMaps).replace(/NUM_SPOT_LIGHT_COORDS/g,t).replace(/NUM_RECT_AREA_LIGHTS/g,e.numRectAreaLights).replace(/NUM_POINT_LIGHTS/g,e.numPointLights).replace(/NUM_HEMI_LIGHTS/g,e.numHemiLights).replace(/NUM_SUN_LIGHT_SHADOWS/g,e.numSunLightShadows).replace(/NUM_DIR_LIGHT_SHADOWS/g,e.numDirLightShadows).replace(/NUM_SPOT_LIGHT_SHADOWS_WITH_MAPS/g,e.numSpotLightShadowsWithMaps).replace(/NUM_SPOT_LIGHT_SHADOWS/g,e.numSpotLightShadows).replace(/NUM_POINT_LIGHT_SHADOWS/g,e.numPointLightShadows).replace(/NUM_LIGHT_PROBE_GRIDS/g,e.numLightProbeGrids)}function X0(i,e){return i.replace(/NUM_CLIPPING_PLANES/g,e.numClippingPlanes).replace(/UNION_CLIPPING_PLANES/g,e.numClippingPlanes-e.numClipIntersection)}var fA=/^[ \t]*#include +<([\w\d./]+)>/gm;function Ad(i){return i.replace(fA,dA)}function dA(i,e){let t=ft[e];if(t===void 0)throw new Error("THREE.WebGLProgram: Can not resolve #include <"+e+">");return Ad(t)}var pA=/#pragma unroll_loop_start\s+for\s*\(\s*int\s+i\s*=\s*(\d+)\s*;\s*i\s*<\s*(\d+)\s*;\s*i\s*\+\+\s*\)\s*{([\s\S]+?)}\s+#pragma unroll_loop_end/g;function $0(i){return i.replace(pA,mA)}function mA(i,e,t,n){let s="";for(let r=parseInt(e);r<parseInt(t);r++)s+=n.replace(/\[\s*i\s*\]/g,"[ "+r+" ]").replace(/UNROLLED_LOOP_INDEX/g,r);return s}function q0(i){let e=`precision ${i.precision} float;
	precision ${i.precision} int;
	precision ${i.precision} sampler2D;
	precision ${i.precision} samplerCube;
	precision ${i.precision} sampler3D;
	precision ${i.precision} sampler2DArray;
	precision ${i.precision} sampler2DShadow;
	precision ${i.precision} samplerCubeShadow;
	precision ${i.precision} sampler2DArrayShadow;
	precision ${i.precision} isampler2D;
	precision ${i.precision} isampler3D;
	precision ${i.precision} isamplerCube;
	precision ${i.precision} isampler2DArray;
	precision ${i.precision} usampler2D;
	precision ${i.precision} usampler3D;
	precision ${i.precision} usamplerCube;
	precision ${i.precision} usampler2DArray;
	`;return i.precision==="highp"?e+=`
#define HIGH_PRECISION`:i.precision==="mediump"?e+=`
#define MEDIUM_PRECISION`:i.precision==="lowp"&&(e+=`
#define LOW_PRECISION`),e}var gA={[Ka]:"SHADOWMAP_TYPE_PCF",[zo]:"SHADOWMAP_TYPE_VSM"};function yA(i){return gA[i.shadowMapType]||"SHADOWMAP_TYPE_BASIC"}var _A={[Ho]:"ENVMAP_MODE_REFRACTION"};function xA(i){return i.envMap===!1?"ENVMAP_MODE_REFLECTION":_A[i.envMapMode]||"ENVMAP_MODE_REFLECTION"}var vA={[Jc]:"ENVMAP_BLENDING_MULTIPLY",[c0]:"ENVMAP_BLENDING_MIX",[h0]:"ENVMAP_BLENDING_ADD"};function bA(i){return i.envMap===!1?"ENVMAP_BLENDING_NONE":vA[i.combine]||"ENVMAP_BLENDING_NONE"}function MA(i,e,t,n){let s=i.getContext(),r=t.defines,o=t.vertexShader,a=t.fragmentShader,l=yA(t),c=t.envMapPMREM===!0?"ENVMAP_TYPE_PMREM":"ENVMAP_TYPE_CUBE",h=xA(t),u=bA(t),f=cA(t),p=hA(r),g=s.createProgram(),x,m,d=t.glslVersion?"#version "+t.glslVersion+`
`:"";t.isRawShaderMaterial?(x=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,p].filter(rl).join(`
`),x.length>0&&(x+=`
`),m=["#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,p].filter(rl).join(`
`),m.length>0&&(m+=`
`)):(x=[q0(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,p,t.extensionClipCullDistance?"#define USE_CLIP_DISTANCE":"",t.batching?"#define USE_BATCHING":"",t.batchingColor?"#define USE_BATCHING_COLOR":"",t.instancing?"#define USE_INSTANCING":"",t.instancingColor?"#define USE_INSTANCING_COLOR":"",t.instancingMorph?"#define USE_INSTANCING_MORPH":"",t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.map?"#define USE_MAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+h:"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.displacementMap?"#define USE_DISPLACEMENTMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.mapUv?"#define MAP_UV "+t.mapUv:"",t.alphaMapUv?"#define ALPHAMAP_UV "+t.alphaMapUv:"",t.lightMapUv?"#define LIGHTMAP_UV "+t.lightMapUv:"",t.aoMapUv?"#define AOMAP_UV "+t.aoMapUv:"",t.emissiveMapUv?"#define EMISSIVEMAP_UV "+t.emissiveMapUv:"",t.bumpMapUv?"#define BUMPMAP_UV "+t.bumpMapUv:"",t.normalMapUv?"#define NORMALMAP_UV "+t.normalMapUv:"",t.displacementMapUv?"#define DISPLACEMENTMAP_UV "+t.displacementMapUv:"",t.metalnessMapUv?"#define METALNESSMAP_UV "+t.metalnessMapUv:"",t.roughnessMapUv?"#define ROUGHNESSMAP_UV "+t.roughnessMapUv:"",t.anisotropyMapUv?"#define ANISOTROPYMAP_UV "+t.anisotropyMapUv:"",t.clearcoatMapUv?"#define CLEARCOATMAP_UV "+t.clearcoatMapUv:"",t.clearcoatNormalMapUv?"#define CLEARCOAT_NORMALMAP_UV "+t.clearcoatNormalMapUv:"",t.clearcoatRoughnessMapUv?"#define CLEARCOAT_ROUGHNESSMAP_UV "+t.clearcoatRoughnessMapUv:"",t.diffuseRoughnessMapUv?"#define DIFFUSE_ROUGHNESSMAP_UV "+t.diffuseRoughnessMapUv:"",t.iridescenceMapUv?"#define IRIDESCENCEMAP_UV "+t.iridescenceMapUv:"",t.iridescenceThicknessMapUv?"#define IRIDESCENCE_THICKNESSMAP_UV "+t.iridescenceThicknessMapUv:"",t.sheenColorMapUv?"#define SHEEN_COLORMAP_UV "+t.sheenColorMapUv:"",t.sheenRoughnessMapUv?"#define SHEEN_ROUGHNESSMAP_UV "+t.sheenRoughnessMapUv:"",t.specularMapUv?"#define SPECULARMAP_UV "+t.specularMapUv:"",t.specularColorMapUv?"#define SPECULAR_COLORMAP_UV "+t.specularColorMapUv:"",t.specularIntensityMapUv?"#define SPECULAR_INTENSITYMAP_UV "+t.specularIntensityMapUv:"",t.transmissionMapUv?"#define TRANSMISSIONMAP_UV "+t.transmissionMapUv:"",t.thicknessMapUv?"#define THICKNESSMAP_UV "+t.thicknessMapUv:"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexNormals?"#define HAS_NORMAL":"",t.vertexColors?"#define USE_COLOR":"",t.vertexAlphas?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.flatShading?"#define FLAT_SHADED":"",t.skinning?"#define USE_SKINNING":"",t.morphTargets?"#define USE_MORPHTARGETS":"",t.morphNormals&&t.flatShading===!1?"#define USE_MORPHNORMALS":"",t.morphColors?"#define USE_MORPHCOLORS":"",t.morphTargetsCount>0?"#define MORPHTARGETS_TEXTURE_STRIDE "+t.morphTextureStride:"",t.morphTargetsCount>0?"#define MORPHTARGETS_COUNT "+t.morphTargetsCount:"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.sizeAttenuation?"#define USE_SIZEATTENUATION":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 modelMatrix;","uniform mat4 modelViewMatrix;","uniform mat4 projectionMatrix;","uniform mat4 viewMatrix;","uniform mat3 normalMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;","#ifdef USE_INSTANCING","	attribute mat4 instanceMatrix;","#endif","#ifdef USE_INSTANCING_COLOR","	attribute vec3 instanceColor;","#endif","#ifdef USE_INSTANCING_MORPH","	uniform sampler2D morphTexture;","#endif","attribute vec3 position;","attribute vec3 normal;","attribute vec2 uv;","#ifdef USE_UV1","	attribute vec2 uv1;","#endif","#ifdef USE_UV2","	attribute vec2 uv2;","#endif","#ifdef USE_UV3","	attribute vec2 uv3;","#endif","#ifdef USE_TANGENT","	attribute vec4 tangent;","#endif","#if defined( USE_COLOR_ALPHA )","	attribute vec4 color;","#elif defined( USE_COLOR )","	attribute vec3 color;","#endif","#ifdef USE_SKINNING","	attribute vec4 skinIndex;","	attribute vec4 skinWeight;","#endif",`
`].filter(rl).join(`
`),m=[q0(t),"#define SHADER_TYPE "+t.shaderType,"#define SHADER_NAME "+t.shaderName,p,t.useFog&&t.fog?"#define USE_FOG":"",t.useFog&&t.fogExp2?"#define FOG_EXP2":"",t.alphaToCoverage?"#define ALPHA_TO_COVERAGE":"",t.map?"#define USE_MAP":"",t.matcap?"#define USE_MATCAP":"",t.envMap?"#define USE_ENVMAP":"",t.envMap?"#define "+c:"",t.envMap?"#define "+h:"",t.envMap?"#define "+u:"",t.envMapPMREM?"#define ENVMAP_MAX_LOD "+t.envMapMaxLod+".0":"",t.envMapPMREM?"#define ENVMAP_SIZE "+t.envMapSize+".0":"",t.lightMap?"#define USE_LIGHTMAP":"",t.aoMap?"#define USE_AOMAP":"",t.bumpMap?"#define USE_BUMPMAP":"",t.normalMap?"#define USE_NORMALMAP":"",t.normalMapObjectSpace?"#define USE_NORMALMAP_OBJECTSPACE":"",t.normalMapTangentSpace?"#define USE_NORMALMAP_TANGENTSPACE":"",t.packedNormalMap?"#define USE_PACKED_NORMALMAP":"",t.emissiveMap?"#define USE_EMISSIVEMAP":"",t.anisotropy?"#define USE_ANISOTROPY":"",t.anisotropyMap?"#define USE_ANISOTROPYMAP":"",t.clearcoat?"#define USE_CLEARCOAT":"",t.clearcoatMap?"#define USE_CLEARCOATMAP":"",t.clearcoatRoughnessMap?"#define USE_CLEARCOAT_ROUGHNESSMAP":"",t.clearcoatNormalMap?"#define USE_CLEARCOAT_NORMALMAP":"",t.diffuseRoughness?"#define USE_DIFFUSE_ROUGHNESS":"",t.diffuseRoughnessMap?"#define USE_DIFFUSE_ROUGHNESSMAP":"",t.dispersion?"#define USE_DISPERSION":"",t.retroreflection?"#define USE_RETROREFLECTION":"",t.iridescence?"#define USE_IRIDESCENCE":"",t.iridescenceMap?"#define USE_IRIDESCENCEMAP":"",t.iridescenceThicknessMap?"#define USE_IRIDESCENCE_THICKNESSMAP":"",t.specularMap?"#define USE_SPECULARMAP":"",t.specularColorMap?"#define USE_SPECULAR_COLORMAP":"",t.specularIntensityMap?"#define USE_SPECULAR_INTENSITYMAP":"",t.roughnessMap?"#define USE_ROUGHNESSMAP":"",t.metalnessMap?"#define USE_METALNESSMAP":"",t.alphaMap?"#define USE_ALPHAMAP":"",t.alphaTest?"#define USE_ALPHATEST":"",t.alphaHash?"#define USE_ALPHAHASH":"",t.sheen?"#define USE_SHEEN":"",t.sheenColorMap?"#define USE_SHEEN_COLORMAP":"",t.sheenRoughnessMap?"#define USE_SHEEN_ROUGHNESSMAP":"",t.transmission?"#define USE_TRANSMISSION":"",t.transmissionMap?"#define USE_TRANSMISSIONMAP":"",t.thicknessMap?"#define USE_THICKNESSMAP":"",t.vertexTangents&&t.flatShading===!1?"#define USE_TANGENT":"",t.vertexColors||t.instancingColor?"#define USE_COLOR":"",t.vertexAlphas||t.batchingColor?"#define USE_COLOR_ALPHA":"",t.vertexUv1s?"#define USE_UV1":"",t.vertexUv2s?"#define USE_UV2":"",t.vertexUv3s?"#define USE_UV3":"",t.pointsUvs?"#define USE_POINTS_UV":"",t.gradientMap?"#define USE_GRADIENTMAP":"",t.flatShading?"#define FLAT_SHADED":"",t.doubleSided?"#define DOUBLE_SIDED":"",t.flipSided?"#define FLIP_SIDED":"",t.shadowMapEnabled?"#define USE_SHADOWMAP":"",t.shadowMapEnabled?"#define "+l:"",t.premultipliedAlpha?"#define PREMULTIPLIED_ALPHA":"",t.numLightProbes>0?"#define USE_LIGHT_PROBES":"",t.decodeVideoTexture?"#define DECODE_VIDEO_TEXTURE":"",t.decodeVideoTextureEmissive?"#define DECODE_VIDEO_TEXTURE_EMISSIVE":"",t.logarithmicDepthBuffer?"#define USE_LOGARITHMIC_DEPTH_BUFFER":"",t.reversedDepthBuffer?"#define USE_REVERSED_DEPTH_BUFFER":"","uniform mat4 viewMatrix;","uniform vec3 cameraPosition;","uniform bool isOrthographic;",t.toneMapping!==ms?"#define TONE_MAPPING":"",t.toneMapping!==ms?ft.tonemapping_pars_fragment:"",t.toneMapping!==ms?aA("toneMapping",t.toneMapping):"",t.dithering?"#define DITHERING":"",t.opaque?"#define OPAQUE":"",ft.colorspace_pars_fragment,rA("linearToOutputTexel",t.outputColorSpace),lA(),t.useDepthPacking?"#define DEPTH_PACKING "+t.depthPacking:"",`
`].filter(rl).join(`
`)),o=Ad(o),o=W0(o,t),o=X0(o,t),a=Ad(a),a=W0(a,t),a=X0(a,t),o=$0(o),a=$0(a),t.isRawShaderMaterial!==!0&&(d=`#version 300 es
`,x=[f,"#define attribute in","#define varying out","#define texture2D texture"].join(`
`)+`
`+x,m=["#define varying in",t.glslVersion===hd?"":"layout(location = 0) out highp vec4 pc_fragColor;",t.glslVersion===hd?"":"#define gl_FragColor pc_fragColor","#define gl_FragDepthEXT gl_FragDepth","#define texture2D texture","#define textureCube texture","#define texture2DProj textureProj","#define texture2DLodEXT textureLod","#define texture2DProjLodEXT textureProjLod","#define textureCubeLodEXT textureLod","#define texture2DGradEXT textureGrad","#define texture2DProjGradEXT textureProjGrad","#define textureCubeGradEXT textureGrad"].join(`
`)+`
`+m);let y=d+x+o,w=d+m+a,v=V0(s,s.VERTEX_SHADER,y),E=V0(s,s.FRAGMENT_SHADER,w);s.attachShader(g,v),s.attachShader(g,E),t.index0AttributeName!==void 0?s.bindAttribLocation(g,0,t.index0AttributeName):t.hasPositionAttribute===!0&&s.bindAttribLocation(g,0,"position"),s.linkProgram(g);function S(I){if(i.debug.checkShaderErrors){let L=s.getProgramInfoLog(g)||"",k=s.getShaderInfoLog(v)||"",V=s.getShaderInfoLog(E)||"",R=L.trim(),U=k.trim(),X=V.trim(),H=!0,ae=!0;if(s.getProgramParameter(g,s.LINK_STATUS)===!1)if(H=!1,typeof i.debug.onShaderError=="function")i.debug.onShaderError(s,g,v,E);else{let Y=G0(s,v,"vertex"),J=G0(s,E,"fragment");et("WebGLProgram: Shader Error "+s.getError()+" - VALIDATE_STATUS "+s.getProgramParameter(g,s.VALIDATE_STATUS)+`

Material Name: `+I.name+`
Material Type: `+I.type+`

Program Info Log: `+R+`
`+Y+`
`+J)}else R!==""?Ye("WebGLProgram: Program Info Log:",R):(U===""||X==="")&&(ae=!1);ae&&(I.diagnostics={runnable:H,programLog:R,vertexShader:{log:U,prefix:x},fragmentShader:{log:X,prefix:m}})}s.deleteShader(v),s.deleteShader(E),_=new $o(s,g),M=uA(s,g)}let _;this.getUniforms=function(){return _===void 0&&S(this),_};let M;this.getAttributes=function(){return M===void 0&&S(this),M};let D=t.rendererExtensionParallelShaderCompile===!1;return this.isReady=function(){return D===!1&&(D=s.getProgramParameter(g,tA)),D},this.destroy=function(){n.releaseStatesOfProgram(this),s.deleteProgram(g),this.program=void 0},this.type=t.shaderType,this.name=t.shaderName,this.id=nA++,this.cacheKey=e,this.usedTimes=1,this.program=g,this.vertexShader=v,this.fragmentShader=E,this}var SA=0,Ed=class{constructor(){this.shaderCache=new Map,this.materialCache=new Map}update(e,t,n){let s=this._getShaderCacheForMaterial(e);return s.has(t)===!1&&(s.add(t),t.usedTimes++),s.has(n)===!1&&(s.add(n),n.usedTimes++),this}remove(e){let t=this.materialCache.get(e);for(let n of t)n.usedTimes--,n.usedTimes===0&&this.shaderCache.delete(n.code);return this.materialCache.delete(e),this}getVertexShaderStage(e){return this._getShaderStage(e.vertexShader)}getFragmentShaderStage(e){return this._getShaderStage(e.fragmentShader)}dispose(){this.shaderCache.clear(),this.materialCache.clear()}_getShaderCacheForMaterial(e){let t=this.materialCache,n=t.get(e);return n===void 0&&(n=new Set,t.set(e,n)),n}_getShaderStage(e){let t=this.shaderCache,n=t.get(e);return n===void 0&&(n=new Td(e),t.set(e,n)),n}},Td=class{constructor(e){this.id=SA++,this.code=e,this.usedTimes=0}};function wA(i){return i===hr||i===nl||i===il}function AA(i,e,t,n,s,r){let o=new Fo,a=new Ed,l=new Set,c=[],h=new Map,u=n.logarithmicDepthBuffer,f={MeshDepthMaterial:"depth",MeshDistanceMaterial:"distance",MeshNormalMaterial:"normal",MeshBasicMaterial:"basic",MeshLambertMaterial:"lambert",MeshPhongMaterial:"phong",MeshToonMaterial:"toon",MeshStandardMaterial:"physical",MeshPhysicalMaterial:"physical",MeshMatcapMaterial:"matcap",LineBasicMaterial:"basic",LineDashedMaterial:"dashed",PointsMaterial:"points",ShadowMaterial:"shadow",SpriteMaterial:"sprite"};function p(_){return l.add(_),_===0?"uv":`uv${_}`}function g(_,M,D,I,L,k){let V=I.fog,R=L.geometry,U=_.isMeshStandardMaterial||_.isMeshLambertMaterial||_.isMeshPhongMaterial?I.environment:null,X=_.isMeshStandardMaterial||_.isMeshLambertMaterial&&!_.envMap||_.isMeshPhongMaterial&&!_.envMap,H=e.get(_.envMap||U,X),ae=f[_.type],Y=n.precision;_.precision!==null&&(Y=n.getMaxPrecision(_.precision),Y!==_.precision&&Ye("WebGLProgram.getParameters:",_.precision,"not supported, using",Y,"instead."));let J=R.morphAttributes.position||R.morphAttributes.normal||R.morphAttributes.color,ee=J!==void 0?J.length:0,fe=0;R.morphAttributes.position!==void 0&&(fe=1),R.morphAttributes.normal!==void 0&&(fe=2),R.morphAttributes.color!==void 0&&(fe=3);let ue,Q,me,ge;if(ae){let Ce=ys[ae];ue=Ce.vertexShader,Q=Ce.fragmentShader}else{ue=_.vertexShader,Q=_.fragmentShader;let Ce=a.getVertexShaderStage(_),lt=a.getFragmentShaderStage(_);a.update(_,Ce,lt),me=Ce.id,ge=lt.id}let _e=i.getRenderTarget(),ye=i.state.buffers.depth.getReversed(),He=L.isInstancedMesh===!0,Ke=L.isBatchedMesh===!0,Oe=!!_.map,it=!!_.matcap,at=!!H,st=at&&H.isPMREMTexture===!0,Qt=!!_.aoMap,$t=!!_.lightMap,gn=!!_.bumpMap&&_.wireframe===!1,Bt=!!_.normalMap,Dn=!!_.displacementMap,St=!!_.emissiveMap,En=!!_.metalnessMap,an=!!_.roughnessMap,yn=_.anisotropy>0,z=_.clearcoat>0,Re=_.diffuseRoughness>0,Ze=_.dispersion>0,ot=_.retroreflectivity>0,we=_.iridescence>0,Gt=_.sheen>0,Ge=_.transmission>0,$e=yn&&!!_.anisotropyMap,P=z&&!!_.clearcoatMap,A=z&&!!_.clearcoatNormalMap,$=z&&!!_.clearcoatRoughnessMap,he=Re&&!!_.diffuseRoughnessMap,re=we&&!!_.iridescenceMap,ve=we&&!!_.iridescenceThicknessMap,be=Gt&&!!_.sheenColorMap,te=Gt&&!!_.sheenRoughnessMap,ie=!!_.specularMap,pe=!!_.specularColorMap,B=!!_.specularIntensityMap,se=Ge&&!!_.transmissionMap,ne=Ge&&!!_.thicknessMap,Ae=!!_.gradientMap,xe=!!_.alphaMap,Se=_.alphaTest>0,We=!!_.alphaHash,je=!!_.extensions,ce=ms;_.toneMapped&&(_e===null||_e.isXRRenderTarget===!0)&&(ce=i.toneMapping);let Be=st?H.isCompressedCubeTexture?H.image[0].mipmaps:H.mipmaps:null,Qe={shaderID:ae,shaderType:_.type,shaderName:_.name,vertexShader:ue,fragmentShader:Q,defines:_.defines,customVertexShaderID:me,customFragmentShaderID:ge,isRawShaderMaterial:_.isRawShaderMaterial===!0,glslVersion:_.glslVersion,precision:Y,batching:Ke,batchingColor:Ke&&L._colorsTexture!==null,instancing:He,instancingColor:He&&L.instanceColor!==null,instancingMorph:He&&L.morphTexture!==null,outputColorSpace:_e===null?i.outputColorSpace:_e.isXRRenderTarget===!0?_e.texture.colorSpace:bt.workingColorSpace,alphaToCoverage:!!_.alphaToCoverage,map:Oe,matcap:it,envMap:at,envMapMode:at&&H.mapping,envMapPMREM:st,envMapMaxLod:st?Be.length-1:null,envMapSize:st?Be[0].width:null,aoMap:Qt,lightMap:$t,bumpMap:gn,normalMap:Bt,displacementMap:Dn,emissiveMap:St,normalMapObjectSpace:Bt&&_.normalMapType===d0,normalMapTangentSpace:Bt&&_.normalMapType===Oh,packedNormalMap:Bt&&_.normalMapType===Oh&&wA(_.normalMap.format),metalnessMap:En,roughnessMap:an,anisotropy:yn,anisotropyMap:$e,clearcoat:z,clearcoatMap:P,clearcoatNormalMap:A,clearcoatRoughnessMap:$,diffuseRoughness:Re,diffuseRoughnessMap:he,dispersion:Ze,retroreflection:ot,iridescence:we,iridescenceMap:re,iridescenceThicknessMap:ve,sheen:Gt,sheenColorMap:be,sheenRoughnessMap:te,specularMap:ie,specularColorMap:pe,specularIntensityMap:B,transmission:Ge,transmissionMap:se,thicknessMap:ne,gradientMap:Ae,opaque:_.transparent===!1&&_.blending===Vo&&_.alphaToCoverage===!1,alphaMap:xe,alphaTest:Se,alphaHash:We,combine:_.combine,mapUv:Oe&&p(_.map.channel),aoMapUv:Qt&&p(_.aoMap.channel),lightMapUv:$t&&p(_.lightMap.channel),bumpMapUv:gn&&p(_.bumpMap.channel),normalMapUv:Bt&&p(_.normalMap.channel),displacementMapUv:Dn&&p(_.displacementMap.channel),emissiveMapUv:St&&p(_.emissiveMap.channel),metalnessMapUv:En&&p(_.metalnessMap.channel),roughnessMapUv:an&&p(_.roughnessMap.channel),anisotropyMapUv:$e&&p(_.anisotropyMap.channel),clearcoatMapUv:P&&p(_.clearcoatMap.channel),clearcoatNormalMapUv:A&&p(_.clearcoatNormalMap.channel),clearcoatRoughnessMapUv:$&&p(_.clearcoatRoughnessMap.channel),diffuseRoughnessMapUv:he&&p(_.diffuseRoughnessMap.channel),iridescenceMapUv:re&&p(_.iridescenceMap.channel),iridescenceThicknessMapUv:ve&&p(_.iridescenceThicknessMap.channel),sheenColorMapUv:be&&p(_.sheenColorMap.channel),sheenRoughnessMapUv:te&&p(_.sheenRoughnessMap.channel),specularMapUv:ie&&p(_.specularMap.channel),specularColorMapUv:pe&&p(_.specularColorMap.channel),specularIntensityMapUv:B&&p(_.specularIntensityMap.channel),transmissionMapUv:se&&p(_.transmissionMap.channel),thicknessMapUv:ne&&p(_.thicknessMap.channel),alphaMapUv:xe&&p(_.alphaMap.channel),vertexTangents:!!R.attributes.tangent&&(Bt||yn),vertexNormals:!!R.attributes.normal,vertexColors:_.vertexColors,vertexAlphas:_.vertexColors===!0&&!!R.attributes.color&&R.attributes.color.itemSize===4,pointsUvs:L.isPoints===!0&&!!R.attributes.uv&&(Oe||xe),fog:!!V,useFog:_.fog===!0,fogExp2:!!V&&V.isFogExp2,flatShading:_.wireframe===!1&&(_.flatShading===!0||R.attributes.normal===void 0&&Bt===!1&&(_.isMeshLambertMaterial||_.isMeshPhongMaterial||_.isMeshStandardMaterial||_.isMeshPhysicalMaterial)),sizeAttenuation:_.sizeAttenuation===!0,logarithmicDepthBuffer:u,reversedDepthBuffer:ye,skinning:L.isSkinnedMesh===!0,hasPositionAttribute:R.attributes.position!==void 0,morphTargets:R.morphAttributes.position!==void 0,morphNormals:R.morphAttributes.normal!==void 0,morphColors:R.morphAttributes.color!==void 0,morphTargetsCount:ee,morphTextureStride:fe,numSunLights:M.sun.length,numDirLights:M.directional.length,numPointLights:M.point.length,numSpotLights:M.spot.length,numSpotLightMaps:M.spotLightMap.length,numRectAreaLights:M.rectArea.length,numHemiLights:M.hemi.length,numSunLightShadows:M.sunShadowMap.length,numDirLightShadows:M.directionalShadowMap.length,numPointLightShadows:M.pointShadowMap.length,numSpotLightShadows:M.spotShadowMap.length,numSpotLightShadowsWithMaps:M.numSpotLightShadowsWithMaps,numLightProbes:M.numLightProbes,numLightProbeGrids:k.filter(Ce=>Ce.texture!==null).length,numClippingPlanes:r.numPlanes,numClipIntersection:r.numIntersection,dithering:_.dithering,shadowMapEnabled:i.shadowMap.enabled&&D.length>0,shadowMapType:i.shadowMap.type,toneMapping:ce,decodeVideoTexture:Oe&&_.map.isVideoTexture===!0&&bt.getTransfer(_.map.colorSpace)===Dt,decodeVideoTextureEmissive:St&&_.emissiveMap.isVideoTexture===!0&&bt.getTransfer(_.emissiveMap.colorSpace)===Dt,premultipliedAlpha:_.premultipliedAlpha,doubleSided:_.side===di,flipSided:_.side===ui,useDepthPacking:_.depthPacking>=0,depthPacking:_.depthPacking||0,index0AttributeName:_.index0AttributeName,extensionClipCullDistance:je&&_.extensions.clipCullDistance===!0&&t.has("WEBGL_clip_cull_distance"),extensionMultiDraw:(je&&_.extensions.multiDraw===!0||Ke)&&t.has("WEBGL_multi_draw"),rendererExtensionParallelShaderCompile:t.has("KHR_parallel_shader_compile"),customProgramCacheKey:_.customProgramCacheKey()};return Qe.vertexUv1s=l.has(1),Qe.vertexUv2s=l.has(2),Qe.vertexUv3s=l.has(3),l.clear(),Qe}function x(_){let M=[];if(_.shaderID?M.push(_.shaderID):(M.push(_.customVertexShaderID),M.push(_.customFragmentShaderID)),_.defines!==void 0)for(let D in _.defines)M.push(D),M.push(_.defines[D]);return _.isRawShaderMaterial===!1&&(m(M,_),d(M,_),M.push(i.outputColorSpace)),M.push(_.customProgramCacheKey),M.join()}function m(_,M){_.push(M.precision),_.push(M.outputColorSpace),_.push(M.envMapMode),_.push(M.envMapPMREM),_.push(M.envMapMaxLod),_.push(M.envMapSize),_.push(M.mapUv),_.push(M.alphaMapUv),_.push(M.lightMapUv),_.push(M.aoMapUv),_.push(M.bumpMapUv),_.push(M.normalMapUv),_.push(M.displacementMapUv),_.push(M.emissiveMapUv),_.push(M.metalnessMapUv),_.push(M.roughnessMapUv),_.push(M.anisotropyMapUv),_.push(M.clearcoatMapUv),_.push(M.clearcoatNormalMapUv),_.push(M.clearcoatRoughnessMapUv),_.push(M.diffuseRoughnessMapUv),_.push(M.iridescenceMapUv),_.push(M.iridescenceThicknessMapUv),_.push(M.sheenColorMapUv),_.push(M.sheenRoughnessMapUv),_.push(M.specularMapUv),_.push(M.specularColorMapUv),_.push(M.specularIntensityMapUv),_.push(M.transmissionMapUv),_.push(M.thicknessMapUv),_.push(M.combine),_.push(M.fogExp2),_.push(M.sizeAttenuation),_.push(M.morphTargetsCount),_.push(M.numSunLights),_.push(M.numDirLights),_.push(M.numPointLights),_.push(M.numSpotLights),_.push(M.numSpotLightMaps),_.push(M.numHemiLights),_.push(M.numRectAreaLights),_.push(M.numSunLightShadows),_.push(M.numDirLightShadows),_.push(M.numPointLightShadows),_.push(M.numSpotLightShadows),_.push(M.numSpotLightShadowsWithMaps),_.push(M.numLightProbes),_.push(M.numLightProbeGrids),_.push(M.shadowMapType),_.push(M.toneMapping),_.push(M.numClippingPlanes),_.push(M.numClipIntersection),_.push(M.depthPacking)}function d(_,M){o.disableAll(),M.instancing&&o.enable(0),M.instancingColor&&o.enable(1),M.instancingMorph&&o.enable(2),M.matcap&&o.enable(3),M.envMap&&o.enable(4),M.normalMapObjectSpace&&o.enable(5),M.normalMapTangentSpace&&o.enable(6),M.clearcoat&&o.enable(7),M.iridescence&&o.enable(8),M.alphaTest&&o.enable(9),M.vertexColors&&o.enable(10),M.vertexAlphas&&o.enable(11),M.vertexUv1s&&o.enable(12),M.vertexUv2s&&o.enable(13),M.vertexUv3s&&o.enable(14),M.vertexTangents&&o.enable(15),M.anisotropy&&o.enable(16),M.alphaHash&&o.enable(17),M.batching&&o.enable(18),M.dispersion&&o.enable(19),M.retroreflection&&o.enable(24),M.diffuseRoughness&&o.enable(25),M.batchingColor&&o.enable(20),M.gradientMap&&o.enable(21),M.packedNormalMap&&o.enable(22),M.vertexNormals&&o.enable(23),_.push(o.mask),o.disableAll(),M.fog&&o.enable(0),M.useFog&&o.enable(1),M.flatShading&&o.enable(2),M.logarithmicDepthBuffer&&o.enable(3),M.reversedDepthBuffer&&o.enable(4),M.skinning&&o.enable(5),M.morphTargets&&o.enable(6),M.morphNormals&&o.enable(7),M.morphColors&&o.enable(8),M.premultipliedAlpha&&o.enable(9),M.shadowMapEnabled&&o.enable(10),M.doubleSided&&o.enable(11),M.flipSided&&o.enable(12),M.useDepthPacking&&o.enable(13),M.dithering&&o.enable(14),M.transmission&&o.enable(15),M.sheen&&o.enable(16),M.opaque&&o.enable(17),M.pointsUvs&&o.enable(18),M.decodeVideoTexture&&o.enable(19),M.decodeVideoTextureEmissive&&o.enable(20),M.alphaToCoverage&&o.enable(21),M.numLightProbeGrids>0&&o.enable(22),M.hasPositionAttribute&&o.enable(23),_.push(o.mask)}function y(_){let M=f[_.type],D;if(M){let I=ys[M];D=C0.clone(I.uniforms)}else D=_.uniforms;return D}function w(_,M){let D=h.get(M);return D!==void 0?++D.usedTimes:(D=new MA(i,M,_,s),c.push(D),h.set(M,D)),D}function v(_){if(--_.usedTimes===0){let M=c.indexOf(_);c[M]=c[c.length-1],c.pop(),h.delete(_.cacheKey),_.destroy()}}function E(_){a.remove(_)}function S(){a.dispose()}return{getParameters:g,getProgramCacheKey:x,getUniforms:y,acquireProgram:w,releaseProgram:v,releaseShaderCache:E,programs:c,dispose:S}}function EA(){let i=new WeakMap;function e(o){return i.has(o)}function t(o){let a=i.get(o);return a===void 0&&(a={},i.set(o,a)),a}function n(o){i.delete(o)}function s(o,a,l){i.get(o)[a]=l}function r(){i=new WeakMap}return{has:e,get:t,remove:n,update:s,dispose:r}}function TA(i,e){return i.groupOrder!==e.groupOrder?i.groupOrder-e.groupOrder:i.renderOrder!==e.renderOrder?i.renderOrder-e.renderOrder:i.material.id!==e.material.id?i.material.id-e.material.id:i.materialVariant!==e.materialVariant?i.materialVariant-e.materialVariant:i.z!==e.z?i.z-e.z:i.id-e.id}function Y0(i,e){return i.groupOrder!==e.groupOrder?i.groupOrder-e.groupOrder:i.renderOrder!==e.renderOrder?i.renderOrder-e.renderOrder:i.z!==e.z?e.z-i.z:i.id-e.id}function Z0(){let i=[],e=0,t=[],n=[],s=[];function r(){e=0,t.length=0,n.length=0,s.length=0}function o(f){let p=0;return f.isInstancedMesh&&(p+=2),f.isSkinnedMesh&&(p+=1),p}function a(f,p,g,x,m,d){let y=i[e];return y===void 0?(y={id:f.id,object:f,geometry:p,material:g,materialVariant:o(f),groupOrder:x,renderOrder:f.renderOrder,z:m,group:d},i[e]=y):(y.id=f.id,y.object=f,y.geometry=p,y.material=g,y.materialVariant=o(f),y.groupOrder=x,y.renderOrder=f.renderOrder,y.z=m,y.group=d),e++,y}function l(f,p,g,x,m,d,y){y.reversedDepth===!0&&(m=-m);let w=a(f,p,g,x,m,d);g.transmission>0?n.push(w):g.transparent===!0?s.push(w):t.push(w)}function c(f,p,g,x,m,d){let y=a(f,p,g,x,m,d);g.transmission>0?n.unshift(y):g.transparent===!0?s.unshift(y):t.unshift(y)}function h(f,p){t.length>1&&t.sort(f||TA),n.length>1&&n.sort(p||Y0),s.length>1&&s.sort(p||Y0)}function u(){for(let f=e,p=i.length;f<p;f++){let g=i[f];if(g.id===null)break;g.id=null,g.object=null,g.geometry=null,g.material=null,g.group=null}}return{opaque:t,transmissive:n,transparent:s,init:r,push:l,unshift:c,finish:u,sort:h}}function CA(){let i=new WeakMap;function e(n,s){let r=i.get(n),o;return r===void 0?(o=new Z0,i.set(n,[o])):s>=r.length?(o=new Z0,r.push(o)):o=r[s],o}function t(){i=new WeakMap}return{get:e,dispose:t}}function RA(){let i={};return{get:function(e){if(i[e.id]!==void 0)return i[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={direction:new O,color:new dt};break;case"SpotLight":t={position:new O,direction:new O,color:new dt,distance:0,coneCos:0,penumbraCos:0,decay:0};break;case"PointLight":t={position:new O,color:new dt,distance:0,decay:0};break;case"HemisphereLight":t={direction:new O,skyColor:new dt,groundColor:new dt};break;case"RectAreaLight":t={color:new dt,position:new O,halfWidth:new O,halfHeight:new O};break}return i[e.id]=t,t}}}function IA(){let i={};return{get:function(e){if(i[e.id]!==void 0)return i[e.id];let t;switch(e.type){case"SunLight":case"DirectionalLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new qe};break;case"SpotLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new qe};break;case"PointLight":t={shadowIntensity:1,shadowBias:0,shadowNormalBias:0,shadowRadius:1,shadowMapSize:new qe,shadowCameraNear:1,shadowCameraFar:1e3};break}return i[e.id]=t,t}}}var PA=0;function LA(i,e){return(e.castShadow?2:0)-(i.castShadow?2:0)+(e.map?1:0)-(i.map?1:0)}function DA(i){let e=new RA,t=IA(),n={version:0,hash:{sunLength:-1,directionalLength:-1,pointLength:-1,spotLength:-1,rectAreaLength:-1,hemiLength:-1,numSunShadows:-1,numDirectionalShadows:-1,numPointShadows:-1,numSpotShadows:-1,numSpotMaps:-1,numLightProbes:-1},ambient:[0,0,0],probe:[],sun:[],sunShadow:[],sunShadowMap:[],sunShadowMatrix:[],sunShadowCascade:[],directional:[],directionalShadow:[],directionalShadowMap:[],directionalShadowMatrix:[],spot:[],spotLightMap:[],spotShadow:[],spotShadowMap:[],spotLightMatrix:[],rectArea:[],rectAreaLTC1:null,rectAreaLTC2:null,point:[],pointShadow:[],pointShadowMap:[],pointShadowMatrix:[],hemi:[],numSpotLightShadowsWithMaps:0,numLightProbes:0};for(let c=0;c<9;c++)n.probe.push(new O);let s=new O,r=new Vt,o=new Vt;function a(c){let h=0,u=0,f=0;for(let k=0;k<9;k++)n.probe[k].set(0,0,0);let p=0,g=0,x=0,m=0,d=0,y=0,w=0,v=0,E=0,S=0,_=0,M=0,D=0,I=0;c.sort(LA);for(let k=0,V=c.length;k<V;k++){let R=c[k],U=R.color,X=R.intensity,H=R.distance,ae=null;if(R.shadow&&R.shadow.map&&(R.shadow.map.texture.format===hr?ae=R.shadow.map.texture:ae=R.shadow.map.depthTexture||R.shadow.map.texture),R.isAmbientLight)h+=U.r*X,u+=U.g*X,f+=U.b*X;else if(R.isLightProbe){for(let Y=0;Y<9;Y++)n.probe[Y].addScaledVector(R.sh.coefficients[Y],X);I++}else if(R.isSunLight){let Y=e.get(R);if(Y.color.copy(R.color).multiplyScalar(R.intensity),R.castShadow){let J=R.shadow,ee=t.get(R);ee.shadowIntensity=J.intensity,ee.shadowBias=J.bias,ee.shadowNormalBias=J.normalBias,ee.shadowRadius=J.radius,ee.shadowMapSize.copy(J.mapSize).multiply(J.getFrameExtents()),n.sunShadow[g]=ee,n.sunShadowMap[g]=ae;let fe=J.getViewportCount();for(let ue=0;ue<fe;ue++)n.sunShadowMatrix[x+ue]=J.getMatrix(ue),n.sunShadowCascade[x+ue]=J._cascadeData[ue];x+=fe,g++}n.sun[p]=Y,p++}else if(R.isDirectionalLight){let Y=e.get(R);if(Y.color.copy(R.color).multiplyScalar(R.intensity),R.castShadow){let J=R.shadow,ee=t.get(R);ee.shadowIntensity=J.intensity,ee.shadowBias=J.bias,ee.shadowNormalBias=J.normalBias,ee.shadowRadius=J.radius,ee.shadowMapSize=J.mapSize,n.directionalShadow[m]=ee,n.directionalShadowMap[m]=ae,n.directionalShadowMatrix[m]=R.shadow.matrix,E++}n.directional[m]=Y,m++}else if(R.isSpotLight){let Y=e.get(R);Y.position.setFromMatrixPosition(R.matrixWorld),Y.color.copy(U).multiplyScalar(X),Y.distance=H,Y.coneCos=Math.cos(R.angle),Y.penumbraCos=Math.cos(R.angle*(1-R.penumbra)),Y.decay=R.decay,n.spot[y]=Y;let J=R.shadow;if(R.map&&(n.spotLightMap[M]=R.map,M++,J.updateMatrices(R),R.castShadow&&D++),n.spotLightMatrix[y]=J.matrix,R.castShadow){let ee=t.get(R);ee.shadowIntensity=J.intensity,ee.shadowBias=J.bias,ee.shadowNormalBias=J.normalBias,ee.shadowRadius=J.radius,ee.shadowMapSize=J.mapSize,n.spotShadow[y]=ee,n.spotShadowMap[y]=ae,_++}y++}else if(R.isRectAreaLight){let Y=e.get(R);Y.color.copy(U).multiplyScalar(X),Y.halfWidth.set(R.width*.5,0,0),Y.halfHeight.set(0,R.height*.5,0),n.rectArea[w]=Y,w++}else if(R.isPointLight){let Y=e.get(R);if(Y.color.copy(R.color).multiplyScalar(R.intensity),Y.distance=R.distance,Y.decay=R.decay,R.castShadow){let J=R.shadow,ee=t.get(R);ee.shadowIntensity=J.intensity,ee.shadowBias=J.bias,ee.shadowNormalBias=J.normalBias,ee.shadowRadius=J.radius,ee.shadowMapSize=J.mapSize,ee.shadowCameraNear=J.camera.near,ee.shadowCameraFar=J.camera.far,n.pointShadow[d]=ee,n.pointShadowMap[d]=ae,n.pointShadowMatrix[d]=R.shadow.matrix,S++}n.point[d]=Y,d++}else if(R.isHemisphereLight){let Y=e.get(R);Y.skyColor.copy(R.color).multiplyScalar(X),Y.groundColor.copy(R.groundColor).multiplyScalar(X),n.hemi[v]=Y,v++}}w>0&&(i.has("OES_texture_float_linear")===!0?(n.rectAreaLTC1=Le.LTC_FLOAT_1,n.rectAreaLTC2=Le.LTC_FLOAT_2):(n.rectAreaLTC1=Le.LTC_HALF_1,n.rectAreaLTC2=Le.LTC_HALF_2)),n.ambient[0]=h,n.ambient[1]=u,n.ambient[2]=f;let L=n.hash;(L.sunLength!==p||L.directionalLength!==m||L.pointLength!==d||L.spotLength!==y||L.rectAreaLength!==w||L.hemiLength!==v||L.numSunShadows!==g||L.numDirectionalShadows!==E||L.numPointShadows!==S||L.numSpotShadows!==_||L.numSpotMaps!==M||L.numLightProbes!==I)&&(n.sun.length=p,n.directional.length=m,n.spot.length=y,n.rectArea.length=w,n.point.length=d,n.hemi.length=v,n.sunShadow.length=g,n.sunShadowMap.length=g,n.sunShadowMatrix.length=x,n.sunShadowCascade.length=x,n.directionalShadow.length=E,n.directionalShadowMap.length=E,n.directionalShadowMatrix.length=E,n.pointShadow.length=S,n.pointShadowMap.length=S,n.pointShadowMatrix.length=S,n.spotShadow.length=_,n.spotShadowMap.length=_,n.spotLightMatrix.length=_+M-D,n.spotLightMap.length=M,n.numSpotLightShadowsWithMaps=D,n.numLightProbes=I,L.sunLength=p,L.directionalLength=m,L.pointLength=d,L.spotLength=y,L.rectAreaLength=w,L.hemiLength=v,L.numSunShadows=g,L.numDirectionalShadows=E,L.numPointShadows=S,L.numSpotShadows=_,L.numSpotMaps=M,L.numLightProbes=I,n.version=PA++)}function l(c,h){let u=0,f=0,p=0,g=0,x=0,m=0,d=h.matrixWorldInverse;for(let y=0,w=c.length;y<w;y++){let v=c[y];if(v.isSunLight){let E=n.sun[u];E.direction.setFromMatrixPosition(v.matrixWorld),E.direction.transformDirection(d),u++}else if(v.isDirectionalLight){let E=n.directional[f];E.direction.setFromMatrixPosition(v.matrixWorld),s.setFromMatrixPosition(v.target.matrixWorld),E.direction.sub(s),E.direction.transformDirection(d),f++}else if(v.isSpotLight){let E=n.spot[g];E.position.setFromMatrixPosition(v.matrixWorld),E.position.applyMatrix4(d),E.direction.setFromMatrixPosition(v.matrixWorld),s.setFromMatrixPosition(v.target.matrixWorld),E.direction.sub(s),E.direction.transformDirection(d),g++}else if(v.isRectAreaLight){let E=n.rectArea[x];E.position.setFromMatrixPosition(v.matrixWorld),E.position.applyMatrix4(d),o.identity(),r.copy(v.matrixWorld),r.premultiply(d),o.extractRotation(r),E.halfWidth.set(v.width*.5,0,0),E.halfHeight.set(0,v.height*.5,0),E.halfWidth.applyMatrix4(o),E.halfHeight.applyMatrix4(o),x++}else if(v.isPointLight){let E=n.point[p];E.position.setFromMatrixPosition(v.matrixWorld),E.position.applyMatrix4(d),p++}else if(v.isHemisphereLight){let E=n.hemi[m];E.direction.setFromMatrixPosition(v.matrixWorld),E.direction.transformDirection(d),m++}}}return{setup:a,setupView:l,state:n}}function K0(i){let e=new DA(i),t=[],n=[],s=[];function r(u){h.camera=u,t.length=0,n.length=0,s.length=0}function o(u){u.isLightProbeGrid?s.push(u):t.push(u)}function a(u){n.push(u)}function l(){e.setup(t),s.sort((u,f)=>u.priority-f.priority||u.id-f.id)}function c(u){e.setupView(t,u)}let h={lightsArray:t,shadowsArray:n,lightProbeGridArray:s,camera:null,lights:e,transmissionRenderTarget:{},textureUnits:0};return{init:r,state:h,setupLights:l,setupLightsView:c,pushLight:o,pushShadow:a}}function NA(i){let e=new WeakMap;function t(s,r=0){let o=e.get(s),a;return o===void 0?(a=new K0(i),e.set(s,[a])):r>=o.length?(a=new K0(i),o.push(a)):a=o[r],a}function n(){e=new WeakMap}return{get:t,dispose:n}}var UA=`void main() {
	gl_Position = vec4( position, 1.0 );
}`,FA=`uniform sampler2D shadow_pass;
uniform vec2 resolution;
uniform float radius;
void main() {
	const float samples = float( VSM_SAMPLES );
	float mean = 0.0;
	float squared_mean = 0.0;
	float uvStride = samples <= 1.0 ? 0.0 : 2.0 / ( samples - 1.0 );
	float uvStart = samples <= 1.0 ? 0.0 : - 1.0;
	for ( float i = 0.0; i < samples; i ++ ) {
		float uvOffset = uvStart + i * uvStride;
		#ifdef HORIZONTAL_PASS
			vec2 distribution = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( uvOffset, 0.0 ) * radius ) / resolution ).rg;
			mean += distribution.x;
			squared_mean += distribution.y * distribution.y + distribution.x * distribution.x;
		#else
			float depth = texture2D( shadow_pass, ( gl_FragCoord.xy + vec2( 0.0, uvOffset ) * radius ) / resolution ).r;
			mean += depth;
			squared_mean += depth * depth;
		#endif
	}
	mean = mean / samples;
	squared_mean = squared_mean / samples;
	float std_dev = sqrt( max( 0.0, squared_mean - mean * mean ) );
	gl_FragColor = vec4( mean, std_dev, 0.0, 1.0 );
}`,OA=[new O(1,0,0),new O(-1,0,0),new O(0,1,0),new O(0,-1,0),new O(0,0,1),new O(0,0,-1)],kA=[new O(0,-1,0),new O(0,-1,0),new O(0,0,1),new O(0,0,-1),new O(0,-1,0),new O(0,-1,0)],J0=new Vt,sl=new O,bd=new O;function BA(i,e,t){let n=new er,s=new qe,r=new qe,o=new nn,a=new Oc,l=new kc,c={},h=t.maxTextureSize,u={[cr]:ui,[ui]:cr,[di]:di},f=new ps({defines:{VSM_SAMPLES:8},uniforms:{shadow_pass:{value:null},resolution:{value:new qe},radius:{value:4}},vertexShader:UA,fragmentShader:FA}),p=f.clone();p.defines.HORIZONTAL_PASS=1;let g=new ct;g.setAttribute("position",new Ht(new Float32Array([-1,-1,.5,3,-1,.5,-1,3,.5]),3));let x=new _t(g,f),m=this;this.enabled=!1,this.autoUpdate=!0,this.needsUpdate=!1,this.type=Ka;let d=this.type;this.render=function(S,_,M){if(m.enabled===!1||m.autoUpdate===!1&&m.needsUpdate===!1||S.length===0)return;this.type===Wg&&(Ye("WebGLShadowMap: PCFSoftShadowMap has been removed. Using PCFShadowMap instead."),this.type=Ka);let D=i.getRenderTarget(),I=i.getActiveCubeFace(),L=i.getActiveMipmapLevel(),k=i.state;k.setBlending(Dr),k.buffers.depth.getReversed()===!0?k.buffers.color.setClear(0,0,0,0):k.buffers.color.setClear(1,1,1,1),k.buffers.depth.setTest(!0),k.setScissorTest(!1);let V=d!==this.type;V&&_.traverse(function(R){R.material&&(Array.isArray(R.material)?R.material.forEach(U=>U.needsUpdate=!0):R.material.needsUpdate=!0)});for(let R=0,U=S.length;R<U;R++){let X=S[R],H=X.shadow;if(H===void 0){Ye("WebGLShadowMap:",X,"has no shadow.");continue}if(H.autoUpdate===!1&&H.needsUpdate===!1)continue;s.copy(H.mapSize);let ae=H.getFrameExtents();s.multiply(ae),r.copy(H.mapSize),(s.x>h||s.y>h)&&(s.x>h&&(r.x=Math.floor(h/ae.x),s.x=r.x*ae.x,H.mapSize.x=r.x),s.y>h&&(r.y=Math.floor(h/ae.y),s.y=r.y*ae.y,H.mapSize.y=r.y));let Y=i.state.buffers.depth.getReversed();if(H.camera._reversedDepth=Y,H.map===null||V===!0){if(H.map!==null&&(H.map.depthTexture!==null&&(H.map.depthTexture.dispose(),H.map.depthTexture=null),H.map.dispose()),this.type===zo){if(X.isPointLight){Ye("WebGLShadowMap: VSM shadow maps are not supported for PointLights. Use PCF or BasicShadowMap instead.");continue}H.map=new Ci(s.x,s.y,{format:hr,type:ji,minFilter:hi,magFilter:hi,generateMipmaps:!1}),H.map.texture.name=X.name+".shadowMap",H.map.depthTexture=new Us(s.x,s.y,Ji),H.map.depthTexture.name=X.name+".shadowMapDepth",H.map.depthTexture.format=Ls,H.map.depthTexture.compareFunction=null,H.map.depthTexture.minFilter=Bn,H.map.depthTexture.magFilter=Bn}else X.isPointLight?(H.map=new ol(s.x),H.map.depthTexture=new Oa(s.x,Ki)):(H.map=new Ci(s.x,s.y),H.map.depthTexture=new Us(s.x,s.y,Ki)),H.map.depthTexture.name=X.name+".shadowMap",H.map.depthTexture.format=Ls,this.type===Ka?(H.map.depthTexture.compareFunction=Y?ld:ad,H.map.depthTexture.minFilter=hi,H.map.depthTexture.magFilter=hi):(H.map.depthTexture.compareFunction=null,H.map.depthTexture.minFilter=Bn,H.map.depthTexture.magFilter=Bn);H.camera.updateProjectionMatrix()}H.map.isWebGLCubeRenderTarget!==!0&&(H.map.width!==s.x||H.map.height!==s.y)&&H.map.setSize(s.x,s.y);let J=H.map.isWebGLCubeRenderTarget?6:H.getViewportCount();X.isPointLight!==!0&&H.updateMatrices(X,M);let ee=(H.camera.layers.mask&4294967294)!==0?H.camera.layers:M.layers;for(let fe=0;fe<J;fe++){let ue=H.getCamera(fe);if(X.isPointLight){let Q=H.camera,me=H.matrix,ge=X.distance||Q.far;ge!==Q.far&&(Q.far=ge,Q.updateProjectionMatrix()),sl.setFromMatrixPosition(X.matrixWorld),Q.position.copy(sl),bd.copy(Q.position),bd.add(OA[fe]),Q.up.copy(kA[fe]),Q.lookAt(bd),Q.updateMatrixWorld(),me.makeTranslation(-sl.x,-sl.y,-sl.z),J0.multiplyMatrices(Q.projectionMatrix,Q.matrixWorldInverse),H._frustum.setFromProjectionMatrix(J0,Q.coordinateSystem,Q.reversedDepth)}if(H.map.isWebGLCubeRenderTarget)i.setRenderTarget(H.map,fe),i.clear();else{fe===0&&(i.setRenderTarget(H.map),i.clear());let Q=H.getViewport(fe);o.set(r.x*Q.x,r.y*Q.y,r.x*Q.z,r.y*Q.w),k.viewport(o)}n=H.getFrustum(fe),v(_,M,ue,X,ee,this.type)}H.isPointLightShadow!==!0&&this.type===zo&&y(H,M),H.needsUpdate=!1}d=this.type,m.needsUpdate=!1,i.setRenderTarget(D,I,L)};function y(S,_){let M=e.update(x);f.defines.VSM_SAMPLES!==S.blurSamples&&(f.defines.VSM_SAMPLES=S.blurSamples,p.defines.VSM_SAMPLES=S.blurSamples,f.needsUpdate=!0,p.needsUpdate=!0),S.mapPass===null?S.mapPass=new Ci(s.x,s.y,{format:hr,type:ji}):(S.mapPass.width!==S.map.width||S.mapPass.height!==S.map.height)&&S.mapPass.setSize(S.map.width,S.map.height),f.uniforms.shadow_pass.value=S.map.depthTexture,f.uniforms.resolution.value.set(S.map.width,S.map.height),f.uniforms.radius.value=S.radius,i.setRenderTarget(S.mapPass),i.clear(),i.renderBufferDirect(_,null,M,f,x,null),p.uniforms.shadow_pass.value=S.mapPass.texture,p.uniforms.resolution.value.set(S.map.width,S.map.height),p.uniforms.radius.value=S.radius,i.setRenderTarget(S.map),i.clear(),i.renderBufferDirect(_,null,M,p,x,null)}function w(S,_,M,D){let I=null,L=M.isPointLight===!0?S.customDistanceMaterial:S.customDepthMaterial;if(L!==void 0)I=L;else if(I=M.isPointLight===!0?l:a,i.localClippingEnabled&&_.clipShadows===!0&&Array.isArray(_.clippingPlanes)&&_.clippingPlanes.length!==0||_.displacementMap&&_.displacementScale!==0||_.alphaMap&&_.alphaTest>0||_.map&&_.alphaTest>0||_.alphaToCoverage===!0){let k=I.uuid,V=_.uuid,R=c[k];R===void 0&&(R={},c[k]=R);let U=R[V];U===void 0&&(U=I.clone(),R[V]=U,_.addEventListener("dispose",E)),I=U}if(I.visible=_.visible,I.wireframe=_.wireframe,D===zo?I.side=_.shadowSide!==null?_.shadowSide:_.side:I.side=_.shadowSide!==null?_.shadowSide:u[_.side],I.alphaMap=_.alphaMap,I.alphaTest=_.alphaToCoverage===!0?.5:_.alphaTest,I.map=_.map,I.clipShadows=_.clipShadows,I.clippingPlanes=_.clippingPlanes,I.clipIntersection=_.clipIntersection,I.displacementMap=_.displacementMap,I.displacementScale=_.displacementScale,I.displacementBias=_.displacementBias,I.wireframeLinewidth=_.wireframeLinewidth,I.linewidth=_.linewidth,M.isPointLight===!0&&I.isMeshDistanceMaterial===!0){let k=i.properties.get(I);k.light=M}return I}function v(S,_,M,D,I,L){if(S.visible===!1)return;if(S.layers.test(I)&&(S.isMesh||S.isLine||S.isPoints)&&(S.castShadow||S.receiveShadow&&L===zo)&&(!S.frustumCulled||S.intersectsFrustum(n))){S.modelViewMatrix.multiplyMatrices(M.matrixWorldInverse,S.matrixWorld);let R=e.update(S),U=S.material;if(Array.isArray(U)){let X=R.groups;for(let H=0,ae=X.length;H<ae;H++){let Y=X[H],J=U[Y.materialIndex];if(J&&J.visible){let ee=w(S,J,D,L);S.onBeforeShadow(i,S,_,M,R,ee,Y),i.renderBufferDirect(M,null,R,ee,S,Y),S.onAfterShadow(i,S,_,M,R,ee,Y)}}}else if(U.visible){let X=w(S,U,D,L);S.onBeforeShadow(i,S,_,M,R,X,null),i.renderBufferDirect(M,null,R,X,S,null),S.onAfterShadow(i,S,_,M,R,X,null)}}let V=S.children;for(let R=0,U=V.length;R<U;R++)v(V[R],_,M,D,I,L)}function E(S){S.target.removeEventListener("dispose",E);for(let M in c){let D=c[M],I=S.target.uuid;I in D&&(D[I].dispose(),delete D[I])}}}function zA(i,e){function t(){let B=!1,se=new nn,ne=null,Ae=new nn(0,0,0,0);return{setMask:function(xe){ne!==xe&&!B&&(i.colorMask(xe,xe,xe,xe),ne=xe)},setLocked:function(xe){B=xe},setClear:function(xe,Se,We,je,ce){ce===!0&&(xe*=je,Se*=je,We*=je),se.set(xe,Se,We,je),Ae.equals(se)===!1&&(i.clearColor(xe,Se,We,je),Ae.copy(se))},reset:function(){B=!1,ne=null,Ae.set(-1,0,0,0)}}}function n(){let B=!1,se=!1,ne=null,Ae=null,xe=null;return{setReversed:function(Se){if(se!==Se){let We=e.get("EXT_clip_control");Se?We.clipControlEXT(We.LOWER_LEFT_EXT,We.ZERO_TO_ONE_EXT):We.clipControlEXT(We.LOWER_LEFT_EXT,We.NEGATIVE_ONE_TO_ONE_EXT),se=Se;let je=xe;xe=null,this.setClear(je)}},getReversed:function(){return se},setTest:function(Se){Se?ye(i.DEPTH_TEST):He(i.DEPTH_TEST)},setMask:function(Se){ne!==Se&&!B&&(i.depthMask(Se),ne=Se)},setFunc:function(Se){if(se&&(Se=w0[Se]),Ae!==Se){switch(Se){case yc:i.depthFunc(i.NEVER);break;case _c:i.depthFunc(i.ALWAYS);break;case xc:i.depthFunc(i.LESS);break;case Po:i.depthFunc(i.LEQUAL);break;case vc:i.depthFunc(i.EQUAL);break;case bc:i.depthFunc(i.GEQUAL);break;case Mc:i.depthFunc(i.GREATER);break;case Sc:i.depthFunc(i.NOTEQUAL);break;default:i.depthFunc(i.LEQUAL)}Ae=Se}},setLocked:function(Se){B=Se},setClear:function(Se){xe!==Se&&(xe=Se,se&&(Se=1-Se),i.clearDepth(Se))},reset:function(){B=!1,ne=null,Ae=null,xe=null,se=!1}}}function s(){let B=!1,se=null,ne=null,Ae=null,xe=null,Se=null,We=null,je=null,ce=null;return{setTest:function(Be){B||(Be?ye(i.STENCIL_TEST):He(i.STENCIL_TEST))},setMask:function(Be){se!==Be&&!B&&(i.stencilMask(Be),se=Be)},setFunc:function(Be,Qe,Ce){(ne!==Be||Ae!==Qe||xe!==Ce)&&(i.stencilFunc(Be,Qe,Ce),ne=Be,Ae=Qe,xe=Ce)},setOp:function(Be,Qe,Ce){(Se!==Be||We!==Qe||je!==Ce)&&(i.stencilOp(Be,Qe,Ce),Se=Be,We=Qe,je=Ce)},setLocked:function(Be){B=Be},setClear:function(Be){ce!==Be&&(i.clearStencil(Be),ce=Be)},reset:function(){B=!1,se=null,ne=null,Ae=null,xe=null,Se=null,We=null,je=null,ce=null}}}let r=new t,o=new n,a=new s,l={},c=new WeakMap,h={},u={},f={},p=new WeakMap,g=[],x=null,m=!1,d=null,y=null,w=null,v=null,E=null,S=null,_=null,M=new dt(0,0,0),D=0,I=!1,L=null,k=null,V=null,R=null,U=null,X=i.getParameter(i.MAX_COMBINED_TEXTURE_IMAGE_UNITS),H=!1,ae=0,Y=i.getParameter(i.VERSION);Y.indexOf("WebGL")!==-1?(ae=parseFloat(/^WebGL (\d)/.exec(Y)[1]),H=ae>=1):Y.indexOf("OpenGL ES")!==-1&&(ae=parseFloat(/^OpenGL ES (\d)/.exec(Y)[1]),H=ae>=2);let J=null,ee={},fe=i.getParameter(i.SCISSOR_BOX),ue=i.getParameter(i.VIEWPORT),Q=new nn().fromArray(fe),me=new nn().fromArray(ue);function ge(B,se,ne,Ae){let xe=new Uint8Array(4),Se=i.createTexture();i.bindTexture(B,Se),i.texParameteri(B,i.TEXTURE_MIN_FILTER,i.NEAREST),i.texParameteri(B,i.TEXTURE_MAG_FILTER,i.NEAREST);for(let We=0;We<ne;We++)B===i.TEXTURE_3D||B===i.TEXTURE_2D_ARRAY?i.texImage3D(se,0,i.RGBA,1,1,Ae,0,i.RGBA,i.UNSIGNED_BYTE,xe):i.texImage2D(se+We,0,i.RGBA,1,1,0,i.RGBA,i.UNSIGNED_BYTE,xe);return Se}let _e={};_e[i.TEXTURE_2D]=ge(i.TEXTURE_2D,i.TEXTURE_2D,1),_e[i.TEXTURE_CUBE_MAP]=ge(i.TEXTURE_CUBE_MAP,i.TEXTURE_CUBE_MAP_POSITIVE_X,6),_e[i.TEXTURE_2D_ARRAY]=ge(i.TEXTURE_2D_ARRAY,i.TEXTURE_2D_ARRAY,1,1),_e[i.TEXTURE_3D]=ge(i.TEXTURE_3D,i.TEXTURE_3D,1,1),r.setClear(0,0,0,1),o.setClear(1),a.setClear(0),ye(i.DEPTH_TEST),o.setFunc(Po),gn(!1),Bt(zf),ye(i.CULL_FACE),Qt(Dr);function ye(B){h[B]!==!0&&(i.enable(B),h[B]=!0)}function He(B){h[B]!==!1&&(i.disable(B),h[B]=!1)}function Ke(B,se){return f[B]!==se?(i.bindFramebuffer(B,se),f[B]=se,B===i.DRAW_FRAMEBUFFER&&(f[i.FRAMEBUFFER]=se),B===i.FRAMEBUFFER&&(f[i.DRAW_FRAMEBUFFER]=se),!0):!1}function Oe(B,se){let ne=g,Ae=!1;if(B){ne=p.get(se),ne===void 0&&(ne=[],p.set(se,ne));let xe=B.textures;if(ne.length!==xe.length||ne[0]!==i.COLOR_ATTACHMENT0){for(let Se=0,We=xe.length;Se<We;Se++)ne[Se]=i.COLOR_ATTACHMENT0+Se;ne.length=xe.length,Ae=!0}}else ne[0]!==i.BACK&&(ne[0]=i.BACK,Ae=!0);Ae&&i.drawBuffers(ne)}function it(B){return x!==B?(i.useProgram(B),x=B,!0):!1}let at={[Nr]:i.FUNC_ADD,[$g]:i.FUNC_SUBTRACT,[qg]:i.FUNC_REVERSE_SUBTRACT};at[Yg]=i.MIN,at[Zg]=i.MAX;let st={[Kg]:i.ZERO,[Jg]:i.ONE,[jg]:i.SRC_COLOR,[Wf]:i.SRC_ALPHA,[s0]:i.SRC_ALPHA_SATURATE,[n0]:i.DST_COLOR,[e0]:i.DST_ALPHA,[Qg]:i.ONE_MINUS_SRC_COLOR,[Xf]:i.ONE_MINUS_SRC_ALPHA,[i0]:i.ONE_MINUS_DST_COLOR,[t0]:i.ONE_MINUS_DST_ALPHA,[r0]:i.CONSTANT_COLOR,[o0]:i.ONE_MINUS_CONSTANT_COLOR,[a0]:i.CONSTANT_ALPHA,[l0]:i.ONE_MINUS_CONSTANT_ALPHA};function Qt(B,se,ne,Ae,xe,Se,We,je,ce,Be){if(B===Dr){m===!0&&(He(i.BLEND),m=!1);return}if(m===!1&&(ye(i.BLEND),m=!0),B!==Xg){if(B!==d||Be!==I){if((y!==Nr||E!==Nr)&&(i.blendEquation(i.FUNC_ADD),y=Nr,E=Nr),Be)switch(B){case Vo:i.blendFuncSeparate(i.ONE,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Vf:i.blendFunc(i.ONE,i.ONE);break;case Hf:i.blendFuncSeparate(i.ZERO,i.ONE_MINUS_SRC_COLOR,i.ZERO,i.ONE);break;case Gf:i.blendFuncSeparate(i.DST_COLOR,i.ONE_MINUS_SRC_ALPHA,i.ZERO,i.ONE);break;default:et("WebGLState: Invalid blending: ",B);break}else switch(B){case Vo:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE_MINUS_SRC_ALPHA,i.ONE,i.ONE_MINUS_SRC_ALPHA);break;case Vf:i.blendFuncSeparate(i.SRC_ALPHA,i.ONE,i.ONE,i.ONE);break;case Hf:et("WebGLState: SubtractiveBlending requires material.premultipliedAlpha = true");break;case Gf:et("WebGLState: MultiplyBlending requires material.premultipliedAlpha = true");break;default:et("WebGLState: Invalid blending: ",B);break}w=null,v=null,S=null,_=null,M.set(0,0,0),D=0,d=B,I=Be}return}xe=xe||se,Se=Se||ne,We=We||Ae,(se!==y||xe!==E)&&(i.blendEquationSeparate(at[se],at[xe]),y=se,E=xe),(ne!==w||Ae!==v||Se!==S||We!==_)&&(i.blendFuncSeparate(st[ne],st[Ae],st[Se],st[We]),w=ne,v=Ae,S=Se,_=We),(je.equals(M)===!1||ce!==D)&&(i.blendColor(je.r,je.g,je.b,ce),M.copy(je),D=ce),d=B,I=!1}function $t(B,se){B.side===di?He(i.CULL_FACE):ye(i.CULL_FACE);let ne=B.side===ui;se&&(ne=!ne),gn(ne),B.blending===Vo&&B.transparent===!1?Qt(Dr):Qt(B.blending,B.blendEquation,B.blendSrc,B.blendDst,B.blendEquationAlpha,B.blendSrcAlpha,B.blendDstAlpha,B.blendColor,B.blendAlpha,B.premultipliedAlpha),o.setFunc(B.depthFunc),o.setTest(B.depthTest),o.setMask(B.depthWrite),r.setMask(B.colorWrite);let Ae=B.stencilWrite;a.setTest(Ae),Ae&&(a.setMask(B.stencilWriteMask),a.setFunc(B.stencilFunc,B.stencilRef,B.stencilFuncMask),a.setOp(B.stencilFail,B.stencilZFail,B.stencilZPass)),St(B.polygonOffset,B.polygonOffsetFactor,B.polygonOffsetUnits),B.alphaToCoverage===!0?ye(i.SAMPLE_ALPHA_TO_COVERAGE):He(i.SAMPLE_ALPHA_TO_COVERAGE)}function gn(B){L!==B&&(B?i.frontFace(i.CW):i.frontFace(i.CCW),L=B)}function Bt(B){B!==Hg?(ye(i.CULL_FACE),B!==k&&(B===zf?i.cullFace(i.BACK):B===Gg?i.cullFace(i.FRONT):i.cullFace(i.FRONT_AND_BACK))):He(i.CULL_FACE),k=B}function Dn(B){B!==V&&(H&&i.lineWidth(B),V=B)}function St(B,se,ne){B?(ye(i.POLYGON_OFFSET_FILL),(R!==se||U!==ne)&&(R=se,U=ne,o.getReversed()&&(se=-se,ne=-ne),i.polygonOffset(se,ne))):He(i.POLYGON_OFFSET_FILL)}function En(B){B?ye(i.SCISSOR_TEST):He(i.SCISSOR_TEST)}function an(B){B===void 0&&(B=i.TEXTURE0+X-1),J!==B&&(i.activeTexture(B),J=B)}function yn(B,se,ne){ne===void 0&&(J===null?ne=i.TEXTURE0+X-1:ne=J);let Ae=ee[ne];Ae===void 0&&(Ae={type:void 0,texture:void 0},ee[ne]=Ae),(Ae.type!==B||Ae.texture!==se)&&(J!==ne&&(i.activeTexture(ne),J=ne),i.bindTexture(B,se||_e[B]),Ae.type=B,Ae.texture=se)}function z(){let B=ee[J];B!==void 0&&B.type!==void 0&&(i.bindTexture(B.type,null),B.type=void 0,B.texture=void 0)}function Re(){try{i.compressedTexImage2D(...arguments)}catch(B){et("WebGLState:",B)}}function Ze(){try{i.compressedTexImage3D(...arguments)}catch(B){et("WebGLState:",B)}}function ot(){try{i.texSubImage2D(...arguments)}catch(B){et("WebGLState:",B)}}function we(){try{i.texSubImage3D(...arguments)}catch(B){et("WebGLState:",B)}}function Gt(){try{i.compressedTexSubImage2D(...arguments)}catch(B){et("WebGLState:",B)}}function Ge(){try{i.compressedTexSubImage3D(...arguments)}catch(B){et("WebGLState:",B)}}function $e(){try{i.texStorage2D(...arguments)}catch(B){et("WebGLState:",B)}}function P(){try{i.texStorage3D(...arguments)}catch(B){et("WebGLState:",B)}}function A(){try{i.texImage2D(...arguments)}catch(B){et("WebGLState:",B)}}function $(){try{i.texImage3D(...arguments)}catch(B){et("WebGLState:",B)}}function he(B){return u[B]!==void 0?u[B]:i.getParameter(B)}function re(B,se){u[B]!==se&&(i.pixelStorei(B,se),u[B]=se)}function ve(B){Q.equals(B)===!1&&(i.scissor(B.x,B.y,B.z,B.w),Q.copy(B))}function be(B){me.equals(B)===!1&&(i.viewport(B.x,B.y,B.z,B.w),me.copy(B))}function te(B,se){let ne=c.get(se);ne===void 0&&(ne=new WeakMap,c.set(se,ne));let Ae=ne.get(B);Ae===void 0&&(Ae=i.getUniformBlockIndex(se,B.name),i.uniformBlockBinding(se,Ae,Ae),ne.set(B,Ae))}function ie(B,se,ne){let xe=c.get(se).get(B);l[xe]!==ne&&(i.bindBufferBase(i.UNIFORM_BUFFER,xe,ne),l[xe]=ne)}function pe(){i.disable(i.BLEND),i.disable(i.CULL_FACE),i.disable(i.DEPTH_TEST),i.disable(i.POLYGON_OFFSET_FILL),i.disable(i.SCISSOR_TEST),i.disable(i.STENCIL_TEST),i.disable(i.SAMPLE_ALPHA_TO_COVERAGE),i.blendEquation(i.FUNC_ADD),i.blendFunc(i.ONE,i.ZERO),i.blendFuncSeparate(i.ONE,i.ZERO,i.ONE,i.ZERO),i.blendColor(0,0,0,0),i.colorMask(!0,!0,!0,!0),i.clearColor(0,0,0,0),i.depthMask(!0),i.depthFunc(i.LESS),o.setReversed(!1),i.clearDepth(1),i.stencilMask(4294967295),i.stencilFunc(i.ALWAYS,0,4294967295),i.stencilOp(i.KEEP,i.KEEP,i.KEEP),i.clearStencil(0),i.cullFace(i.BACK),i.frontFace(i.CCW),i.polygonOffset(0,0),i.activeTexture(i.TEXTURE0),i.bindFramebuffer(i.FRAMEBUFFER,null),i.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),i.bindFramebuffer(i.READ_FRAMEBUFFER,null),i.useProgram(null),i.lineWidth(1),i.scissor(0,0,i.canvas.width,i.canvas.height),i.viewport(0,0,i.canvas.width,i.canvas.height),i.pixelStorei(i.PACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_ALIGNMENT,4),i.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,!1),i.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,!1),i.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,i.BROWSER_DEFAULT_WEBGL),i.pixelStorei(i.PACK_ROW_LENGTH,0),i.pixelStorei(i.PACK_SKIP_PIXELS,0),i.pixelStorei(i.PACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_ROW_LENGTH,0),i.pixelStorei(i.UNPACK_IMAGE_HEIGHT,0),i.pixelStorei(i.UNPACK_SKIP_PIXELS,0),i.pixelStorei(i.UNPACK_SKIP_ROWS,0),i.pixelStorei(i.UNPACK_SKIP_IMAGES,0),h={},u={},J=null,ee={},f={},l={},p=new WeakMap,g=[],x=null,m=!1,d=null,y=null,w=null,v=null,E=null,S=null,_=null,M=new dt(0,0,0),D=0,I=!1,L=null,k=null,V=null,R=null,U=null,Q.set(0,0,i.canvas.width,i.canvas.height),me.set(0,0,i.canvas.width,i.canvas.height),r.reset(),o.reset(),a.reset()}return{buffers:{color:r,depth:o,stencil:a},enable:ye,disable:He,bindFramebuffer:Ke,drawBuffers:Oe,useProgram:it,setBlending:Qt,setMaterial:$t,setFlipSided:gn,setCullFace:Bt,setLineWidth:Dn,setPolygonOffset:St,setScissorTest:En,activeTexture:an,bindTexture:yn,unbindTexture:z,compressedTexImage2D:Re,compressedTexImage3D:Ze,texImage2D:A,texImage3D:$,pixelStorei:re,getParameter:he,updateUBOMapping:te,uniformBlockBinding:ie,texStorage2D:$e,texStorage3D:P,texSubImage2D:ot,texSubImage3D:we,compressedTexSubImage2D:Gt,compressedTexSubImage3D:Ge,scissor:ve,viewport:be,reset:pe}}function VA(i,e,t,n,s,r,o){let a=e.has("WEBGL_multisampled_render_to_texture")?e.get("WEBGL_multisampled_render_to_texture"):null,l=typeof navigator>"u"?!1:/OculusBrowser/g.test(navigator.userAgent),c=new qe,h=new WeakMap,u=new Set,f,p=new WeakMap,g=new Set,x=new FinalizationRegistry(P=>g.delete(P)),m=!1;try{m=typeof OffscreenCanvas<"u"&&new OffscreenCanvas(1,1).getContext("2d")!==null}catch{}function d(P,A){return m?new OffscreenCanvas(P,A):Pa("canvas")}function y(P,A,$){let he=1,re=$e(P);if((re.width>$||re.height>$)&&(he=$/Math.max(re.width,re.height)),he<1)if(typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement||typeof HTMLCanvasElement<"u"&&P instanceof HTMLCanvasElement||typeof ImageBitmap<"u"&&P instanceof ImageBitmap||typeof VideoFrame<"u"&&P instanceof VideoFrame){let ve=Math.floor(he*re.width),be=Math.floor(he*re.height);f===void 0&&(f=d(ve,be));let te=A?d(ve,be):f;return te.width=ve,te.height=be,te.getContext("2d").drawImage(P,0,0,ve,be),Ye("WebGLRenderer: Texture has been resized from ("+re.width+"x"+re.height+") to ("+ve+"x"+be+")."),te}else return"data"in P&&Ye("WebGLRenderer: Image in DataTexture is too big ("+re.width+"x"+re.height+")."),P;return P}function w(P){return P.generateMipmaps}function v(P){i.generateMipmap(P)}function E(P){return P.isWebGLCubeRenderTarget?i.TEXTURE_CUBE_MAP:P.isWebGL3DRenderTarget?i.TEXTURE_3D:P.isWebGLArrayRenderTarget||P.isCompressedArrayTexture?i.TEXTURE_2D_ARRAY:i.TEXTURE_2D}function S(P,A,$,he,re,ve=!1){if(P!==null){if(i[P]!==void 0)return i[P];Ye("WebGLRenderer: Attempt to use non-existing WebGL internal format '"+P+"'")}let be;he&&(be=e.get("EXT_texture_norm16"),be||Ye("WebGLRenderer: Unable to use normalized textures without EXT_texture_norm16 extension"));let te=A;if(A===i.RED&&($===i.FLOAT&&(te=i.R32F),$===i.HALF_FLOAT&&(te=i.R16F),$===i.UNSIGNED_BYTE&&(te=i.R8),$===i.UNSIGNED_SHORT&&be&&(te=be.R16_EXT),$===i.SHORT&&be&&(te=be.R16_SNORM_EXT)),A===i.RED_INTEGER&&($===i.UNSIGNED_BYTE&&(te=i.R8UI),$===i.UNSIGNED_SHORT&&(te=i.R16UI),$===i.UNSIGNED_INT&&(te=i.R32UI),$===i.BYTE&&(te=i.R8I),$===i.SHORT&&(te=i.R16I),$===i.INT&&(te=i.R32I)),A===i.RG&&($===i.FLOAT&&(te=i.RG32F),$===i.HALF_FLOAT&&(te=i.RG16F),$===i.UNSIGNED_BYTE&&(te=i.RG8),$===i.UNSIGNED_SHORT&&be&&(te=be.RG16_EXT),$===i.SHORT&&be&&(te=be.RG16_SNORM_EXT)),A===i.RG_INTEGER&&($===i.UNSIGNED_BYTE&&(te=i.RG8UI),$===i.UNSIGNED_SHORT&&(te=i.RG16UI),$===i.UNSIGNED_INT&&(te=i.RG32UI),$===i.BYTE&&(te=i.RG8I),$===i.SHORT&&(te=i.RG16I),$===i.INT&&(te=i.RG32I)),A===i.RGB_INTEGER&&($===i.UNSIGNED_BYTE&&(te=i.RGB8UI),$===i.UNSIGNED_SHORT&&(te=i.RGB16UI),$===i.UNSIGNED_INT&&(te=i.RGB32UI),$===i.BYTE&&(te=i.RGB8I),$===i.SHORT&&(te=i.RGB16I),$===i.INT&&(te=i.RGB32I)),A===i.RGBA_INTEGER&&($===i.UNSIGNED_BYTE&&(te=i.RGBA8UI),$===i.UNSIGNED_SHORT&&(te=i.RGBA16UI),$===i.UNSIGNED_INT&&(te=i.RGBA32UI),$===i.BYTE&&(te=i.RGBA8I),$===i.SHORT&&(te=i.RGBA16I),$===i.INT&&(te=i.RGBA32I)),A===i.RGB&&($===i.UNSIGNED_SHORT&&be&&(te=be.RGB16_EXT),$===i.SHORT&&be&&(te=be.RGB16_SNORM_EXT),$===i.UNSIGNED_INT_5_9_9_9_REV&&(te=i.RGB9_E5),$===i.UNSIGNED_INT_10F_11F_11F_REV&&(te=i.R11F_G11F_B10F)),A===i.RGBA){let ie=ve?Ia:bt.getTransfer(re);$===i.FLOAT&&(te=i.RGBA32F),$===i.HALF_FLOAT&&(te=i.RGBA16F),$===i.UNSIGNED_BYTE&&(te=ie===Dt?i.SRGB8_ALPHA8:i.RGBA8),$===i.UNSIGNED_SHORT&&be&&(te=be.RGBA16_EXT),$===i.SHORT&&be&&(te=be.RGBA16_SNORM_EXT),$===i.UNSIGNED_SHORT_4_4_4_4&&(te=i.RGBA4),$===i.UNSIGNED_SHORT_5_5_5_1&&(te=i.RGB5_A1)}return(te===i.R16F||te===i.R32F||te===i.RG16F||te===i.RG32F||te===i.RGBA16F||te===i.RGBA32F)&&e.get("EXT_color_buffer_float"),te}function _(P,A){let $;return P?A===null||A===Ki||A===Fr?$=i.DEPTH24_STENCIL8:A===Ji?$=i.DEPTH32F_STENCIL8:A===Go&&($=i.DEPTH24_STENCIL8,Ye("DepthTexture: 16 bit depth attachment is not supported with stencil. Using 24-bit attachment.")):A===null||A===Ki||A===Fr?$=i.DEPTH_COMPONENT24:A===Ji?$=i.DEPTH_COMPONENT32F:A===Go&&($=i.DEPTH_COMPONENT16),$}function M(P,A){return w(P)===!0||P.isFramebufferTexture&&P.minFilter!==Bn&&P.minFilter!==hi?Math.log2(Math.max(A.width,A.height))+1:P.mipmaps.length>0?P.mipmaps.length:P.isCompressedTexture&&Array.isArray(P.image)?A.mipmaps.length:1}function D(P){let A=new WeakRef(P);n.get(P).__ref=A,g.add(A),x.register(P,A,A)}function I(P){let A=n.get(P).__ref;A!==void 0&&(g.delete(A),x.unregister(A))}function L(P){V(P.target)}function k(P){R(P.target)}function V(P){P.removeEventListener("dispose",L),I(P),X(P),P.isVideoTexture&&h.delete(P),P.isHTMLTexture&&u.delete(P)}function R(P){P.removeEventListener("dispose",k),I(P),ae(P)}function U(){for(let P of g){let A=P.deref();A!==void 0&&(A.isRenderTarget===!0?R(A):V(A))}g.clear(),u.clear()}function X(P){let A=n.get(P);if(A.__webglInit===void 0)return;let $=P.source,he=p.get($);if(he){let re=he[A.__cacheKey];re.usedTimes--,re.usedTimes===0&&H(P),Object.keys(he).length===0&&p.delete($)}n.remove(P)}function H(P){let A=n.get(P);i.deleteTexture(A.__webglTexture);let $=P.source,he=p.get($);delete he[A.__cacheKey],o.memory.textures--}function ae(P){let A=n.get(P);A.__depthDisposeCallback&&A.__depthDisposeCallback();let $=P.depthTexture;if($&&$.renderTarget===P&&V($),P.isWebGLCubeRenderTarget)for(let re=0;re<6;re++){if(Array.isArray(A.__webglFramebuffer[re]))for(let ve=0;ve<A.__webglFramebuffer[re].length;ve++)i.deleteFramebuffer(A.__webglFramebuffer[re][ve]);else i.deleteFramebuffer(A.__webglFramebuffer[re]);A.__webglDepthbuffer&&i.deleteRenderbuffer(A.__webglDepthbuffer[re])}else{if(Array.isArray(A.__webglFramebuffer))for(let re=0;re<A.__webglFramebuffer.length;re++)i.deleteFramebuffer(A.__webglFramebuffer[re]);else i.deleteFramebuffer(A.__webglFramebuffer);if(A.__webglDepthbuffer&&i.deleteRenderbuffer(A.__webglDepthbuffer),A.__webglMultisampledFramebuffer&&i.deleteFramebuffer(A.__webglMultisampledFramebuffer),A.__webglColorRenderbuffer)for(let re=0;re<A.__webglColorRenderbuffer.length;re++)A.__webglColorRenderbuffer[re]&&i.deleteRenderbuffer(A.__webglColorRenderbuffer[re]);A.__webglDepthRenderbuffer&&i.deleteRenderbuffer(A.__webglDepthRenderbuffer)}let he=P.textures;for(let re=0,ve=he.length;re<ve;re++){let be=n.get(he[re]);be.__webglTexture&&(i.deleteTexture(be.__webglTexture),o.memory.textures--),n.remove(he[re])}n.remove(P)}let Y=0;function J(){Y=0}function ee(){return Y}function fe(P){Y=P}function ue(){let P=Y;return P>=s.maxTextures&&Ye("WebGLTextures: Trying to use "+(P+1)+" texture units while this GPU supports only "+s.maxTextures),Y+=1,P}function Q(P){let A=[];return A.push(P.wrapS),A.push(P.wrapT),A.push(P.wrapR||0),A.push(P.magFilter),A.push(P.minFilter),A.push(P.anisotropy),A.push(P.internalFormat),A.push(P.format),A.push(P.type),A.push(P.generateMipmaps),A.push(P.mipmapsAutoUpdate),A.push(P.premultiplyAlpha),A.push(P.flipY),A.push(P.unpackAlignment),A.push(P.colorSpace),A.join()}function me(P,A){let $=n.get(P);if(P.isVideoTexture&&Gt(P),P.isRenderTargetTexture===!1&&P.isExternalTexture!==!0&&P.version>0&&$.__version!==P.version){let he=P.image;if(he===null)Ye("WebGLRenderer: Texture marked for update but no image data found.");else if(he.complete===!1)Ye("WebGLRenderer: Texture marked for update but image is incomplete");else{$t($,P,A);return}}else P.isExternalTexture&&($.__webglTexture=P.sourceTexture?P.sourceTexture:null);t.bindTexture(i.TEXTURE_2D,$.__webglTexture,i.TEXTURE0+A)}function ge(P,A){let $=n.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&$.__version!==P.version){$t($,P,A);return}else P.isExternalTexture&&($.__webglTexture=P.sourceTexture?P.sourceTexture:null);t.bindTexture(i.TEXTURE_2D_ARRAY,$.__webglTexture,i.TEXTURE0+A)}function _e(P,A){let $=n.get(P);if(P.isRenderTargetTexture===!1&&P.version>0&&$.__version!==P.version){$t($,P,A);return}t.bindTexture(i.TEXTURE_3D,$.__webglTexture,i.TEXTURE0+A)}function ye(P,A){let $=n.get(P);if(P.version>0&&$.__version!==P.version){gn($,P,A);return}t.bindTexture(i.TEXTURE_CUBE_MAP,$.__webglTexture,i.TEXTURE0+A)}let He={[wc]:i.REPEAT,[fs]:i.CLAMP_TO_EDGE,[Ac]:i.MIRRORED_REPEAT},Ke={[Bn]:i.NEAREST,[u0]:i.NEAREST_MIPMAP_NEAREST,[Ja]:i.NEAREST_MIPMAP_LINEAR,[hi]:i.LINEAR,[eh]:i.LINEAR_MIPMAP_NEAREST,[Fs]:i.LINEAR_MIPMAP_LINEAR},Oe={[m0]:i.NEVER,[cd]:i.ALWAYS,[g0]:i.LESS,[ad]:i.LEQUAL,[y0]:i.EQUAL,[ld]:i.GEQUAL,[_0]:i.GREATER,[x0]:i.NOTEQUAL};function it(P,A){if(A.type===Ji&&e.has("OES_texture_float_linear")===!1&&(A.magFilter===hi||A.magFilter===eh||A.magFilter===Ja||A.magFilter===Fs||A.minFilter===hi||A.minFilter===eh||A.minFilter===Ja||A.minFilter===Fs)&&Ye("WebGLRenderer: Unable to use linear filtering with floating point textures. OES_texture_float_linear not supported on this device."),i.texParameteri(P,i.TEXTURE_WRAP_S,He[A.wrapS]),i.texParameteri(P,i.TEXTURE_WRAP_T,He[A.wrapT]),(P===i.TEXTURE_3D||P===i.TEXTURE_2D_ARRAY)&&i.texParameteri(P,i.TEXTURE_WRAP_R,He[A.wrapR]),i.texParameteri(P,i.TEXTURE_MAG_FILTER,Ke[A.magFilter]),i.texParameteri(P,i.TEXTURE_MIN_FILTER,Ke[A.minFilter]),A.compareFunction&&(i.texParameteri(P,i.TEXTURE_COMPARE_MODE,i.COMPARE_REF_TO_TEXTURE),i.texParameteri(P,i.TEXTURE_COMPARE_FUNC,Oe[A.compareFunction])),e.has("EXT_texture_filter_anisotropic")===!0){if(A.magFilter===Bn||A.minFilter!==Ja&&A.minFilter!==Fs||A.type===Ji&&e.has("OES_texture_float_linear")===!1)return;if(A.anisotropy>1||n.get(A).__currentAnisotropy){let $=e.get("EXT_texture_filter_anisotropic");i.texParameterf(P,$.TEXTURE_MAX_ANISOTROPY_EXT,Math.min(A.anisotropy,s.getMaxAnisotropy())),n.get(A).__currentAnisotropy=A.anisotropy}}}function at(P,A){let $=!1;P.__webglInit===void 0&&(P.__webglInit=!0,A.addEventListener("dispose",L),D(A));let he=A.source,re=p.get(he);re===void 0&&(re={},p.set(he,re));let ve=Q(A);if(ve!==P.__cacheKey){re[ve]===void 0&&(re[ve]={texture:i.createTexture(),usedTimes:0},o.memory.textures++,$=!0),re[ve].usedTimes++;let be=re[P.__cacheKey];be!==void 0&&(re[P.__cacheKey].usedTimes--,be.usedTimes===0&&H(A)),P.__cacheKey=ve,P.__webglTexture=re[ve].texture}return $}function st(P,A,$){return Math.floor(Math.floor(P/$)/A)}function Qt(P,A,$,he){let ve=P.updateRanges;if(ve.length===0)t.texSubImage2D(i.TEXTURE_2D,0,0,0,A.width,A.height,$,he,A.data);else{ve.sort((B,se)=>B.start-se.start);let be=0;for(let B=1;B<ve.length;B++){let se=ve[be],ne=ve[B],Ae=se.start+se.count,xe=st(ne.start,A.width,4),Se=st(se.start,A.width,4);ne.start<=Ae+1&&xe===Se&&st(ne.start+ne.count-1,A.width,4)===xe?se.count=Math.max(se.count,ne.start+ne.count-se.start):(++be,ve[be]=ne)}ve.length=be+1;let te=t.getParameter(i.UNPACK_ROW_LENGTH),ie=t.getParameter(i.UNPACK_SKIP_PIXELS),pe=t.getParameter(i.UNPACK_SKIP_ROWS);t.pixelStorei(i.UNPACK_ROW_LENGTH,A.width);for(let B=0,se=ve.length;B<se;B++){let ne=ve[B],Ae=Math.floor(ne.start/4),xe=Math.ceil(ne.count/4),Se=Ae%A.width,We=Math.floor(Ae/A.width),je=xe,ce=1;t.pixelStorei(i.UNPACK_SKIP_PIXELS,Se),t.pixelStorei(i.UNPACK_SKIP_ROWS,We),t.texSubImage2D(i.TEXTURE_2D,0,Se,We,je,ce,$,he,A.data)}P.clearUpdateRanges(),t.pixelStorei(i.UNPACK_ROW_LENGTH,te),t.pixelStorei(i.UNPACK_SKIP_PIXELS,ie),t.pixelStorei(i.UNPACK_SKIP_ROWS,pe)}}function $t(P,A,$){let he=i.TEXTURE_2D;(A.isDataArrayTexture||A.isCompressedArrayTexture)&&(he=i.TEXTURE_2D_ARRAY),A.isData3DTexture&&(he=i.TEXTURE_3D);let re=at(P,A),ve=A.source;t.bindTexture(he,P.__webglTexture,i.TEXTURE0+$);let be=n.get(ve);if(ve.version!==be.__version||re===!0){if(t.activeTexture(i.TEXTURE0+$),(typeof ImageBitmap<"u"&&A.image instanceof ImageBitmap)===!1){let ce=bt.getPrimaries(bt.workingColorSpace),Be=A.colorSpace===ks?null:bt.getPrimaries(A.colorSpace),Qe=A.colorSpace===ks||ce===Be?i.NONE:i.BROWSER_DEFAULT_WEBGL;t.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,A.flipY),t.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,A.premultiplyAlpha),t.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,Qe)}t.pixelStorei(i.UNPACK_ALIGNMENT,A.unpackAlignment);let ie=y(A.image,!1,s.maxTextureSize);ie=Ge(A,ie);let pe=r.convert(A.format,A.colorSpace),B=r.convert(A.type),se=S(A.internalFormat,pe,B,A.normalized,A.colorSpace,A.isVideoTexture);it(he,A);let ne,Ae=A.mipmaps,xe=A.isVideoTexture!==!0,Se=be.__version===void 0||re===!0,We=ve.dataReady,je=M(A,ie);if(A.isDepthTexture)se=_(A.format===Os,A.type),Se&&(xe?t.texStorage2D(i.TEXTURE_2D,1,se,ie.width,ie.height):t.texImage2D(i.TEXTURE_2D,0,se,ie.width,ie.height,0,pe,B,null));else if(A.isDataTexture)if(Ae.length>0){xe&&Se&&t.texStorage2D(i.TEXTURE_2D,je,se,Ae[0].width,Ae[0].height);for(let ce=0,Be=Ae.length;ce<Be;ce++)ne=Ae[ce],xe?We&&t.texSubImage2D(i.TEXTURE_2D,ce,0,0,ne.width,ne.height,pe,B,ne.data):t.texImage2D(i.TEXTURE_2D,ce,se,ne.width,ne.height,0,pe,B,ne.data);A.generateMipmaps=!1}else xe?(Se&&t.texStorage2D(i.TEXTURE_2D,je,se,ie.width,ie.height),We&&Qt(A,ie,pe,B)):t.texImage2D(i.TEXTURE_2D,0,se,ie.width,ie.height,0,pe,B,ie.data);else if(A.isCompressedTexture)if(A.isCompressedArrayTexture){xe&&Se&&t.texStorage3D(i.TEXTURE_2D_ARRAY,je,se,Ae[0].width,Ae[0].height,ie.depth);for(let ce=0,Be=Ae.length;ce<Be;ce++)if(ne=Ae[ce],A.format!==Qi)if(pe!==null)if(xe){if(We)if(A.layerUpdates.size>0){let Qe=xd(ne.width,ne.height,A.format,A.type);for(let Ce of A.layerUpdates){let lt=ne.data.subarray(Ce*Qe/ne.data.BYTES_PER_ELEMENT,(Ce+1)*Qe/ne.data.BYTES_PER_ELEMENT);t.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,ce,0,0,Ce,ne.width,ne.height,1,pe,lt)}}else t.compressedTexSubImage3D(i.TEXTURE_2D_ARRAY,ce,0,0,0,ne.width,ne.height,ie.depth,pe,ne.data)}else t.compressedTexImage3D(i.TEXTURE_2D_ARRAY,ce,se,ne.width,ne.height,ie.depth,0,ne.data,0,0);else Ye("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()");else xe?We&&t.texSubImage3D(i.TEXTURE_2D_ARRAY,ce,0,0,0,ne.width,ne.height,ie.depth,pe,B,ne.data):t.texImage3D(i.TEXTURE_2D_ARRAY,ce,se,ne.width,ne.height,ie.depth,0,pe,B,ne.data);A.layerUpdates.size>0&&A.clearLayerUpdates()}else{xe&&Se&&t.texStorage2D(i.TEXTURE_2D,je,se,Ae[0].width,Ae[0].height);for(let ce=0,Be=Ae.length;ce<Be;ce++)ne=Ae[ce],A.format!==Qi?pe!==null?xe?We&&t.compressedTexSubImage2D(i.TEXTURE_2D,ce,0,0,ne.width,ne.height,pe,ne.data):t.compressedTexImage2D(i.TEXTURE_2D,ce,se,ne.width,ne.height,0,ne.data):Ye("WebGLRenderer: Attempt to load unsupported compressed texture format in .uploadTexture()"):xe?We&&t.texSubImage2D(i.TEXTURE_2D,ce,0,0,ne.width,ne.height,pe,B,ne.data):t.texImage2D(i.TEXTURE_2D,ce,se,ne.width,ne.height,0,pe,B,ne.data)}else if(A.isDataArrayTexture)if(xe){if(Se&&t.texStorage3D(i.TEXTURE_2D_ARRAY,je,se,ie.width,ie.height,ie.depth),We)if(A.layerUpdates.size>0){let ce=xd(ie.width,ie.height,A.format,A.type);for(let Be of A.layerUpdates){let Qe=ie.data.subarray(Be*ce/ie.data.BYTES_PER_ELEMENT,(Be+1)*ce/ie.data.BYTES_PER_ELEMENT);t.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,Be,ie.width,ie.height,1,pe,B,Qe)}A.clearLayerUpdates()}else t.texSubImage3D(i.TEXTURE_2D_ARRAY,0,0,0,0,ie.width,ie.height,ie.depth,pe,B,ie.data)}else t.texImage3D(i.TEXTURE_2D_ARRAY,0,se,ie.width,ie.height,ie.depth,0,pe,B,ie.data);else if(A.isData3DTexture)xe?(Se&&t.texStorage3D(i.TEXTURE_3D,je,se,ie.width,ie.height,ie.depth),We&&t.texSubImage3D(i.TEXTURE_3D,0,0,0,0,ie.width,ie.height,ie.depth,pe,B,ie.data)):t.texImage3D(i.TEXTURE_3D,0,se,ie.width,ie.height,ie.depth,0,pe,B,ie.data);else if(A.isFramebufferTexture){if(Se)if(xe)t.texStorage2D(i.TEXTURE_2D,je,se,ie.width,ie.height);else{let ce=ie.width,Be=ie.height;for(let Qe=0;Qe<je;Qe++)t.texImage2D(i.TEXTURE_2D,Qe,se,ce,Be,0,pe,B,null),ce>>=1,Be>>=1}}else if(A.isHTMLTexture){if("texElementImage2D"in i){let ce=i.canvas;if(ce.hasAttribute("layoutsubtree")||ce.setAttribute("layoutsubtree","true"),ie.parentNode!==ce){ce.appendChild(ie),u.add(A),ce.onpaint=Be=>{let Qe=Be.changedElements;for(let Ce of u)Qe.includes(Ce.image)&&(Ce.needsUpdate=!0)},ce.requestPaint();return}if(i.texElementImage2D.length===3)i.texElementImage2D(i.TEXTURE_2D,i.RGBA8,ie);else{let Qe=i.RGBA,Ce=i.RGBA,lt=i.UNSIGNED_BYTE;i.texElementImage2D(i.TEXTURE_2D,0,Qe,Ce,lt,ie)}i.texParameteri(i.TEXTURE_2D,i.TEXTURE_MIN_FILTER,i.LINEAR),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_S,i.CLAMP_TO_EDGE),i.texParameteri(i.TEXTURE_2D,i.TEXTURE_WRAP_T,i.CLAMP_TO_EDGE)}}else if(Ae.length>0){if(xe&&Se){let ce=$e(Ae[0]);t.texStorage2D(i.TEXTURE_2D,je,se,ce.width,ce.height)}for(let ce=0,Be=Ae.length;ce<Be;ce++)ne=Ae[ce],xe?We&&t.texSubImage2D(i.TEXTURE_2D,ce,0,0,pe,B,ne):t.texImage2D(i.TEXTURE_2D,ce,se,pe,B,ne);A.generateMipmaps=!1}else if(xe){if(Se){let ce=$e(ie);t.texStorage2D(i.TEXTURE_2D,je,se,ce.width,ce.height)}We&&t.texSubImage2D(i.TEXTURE_2D,0,0,0,pe,B,ie)}else t.texImage2D(i.TEXTURE_2D,0,se,pe,B,ie);w(A)&&A.mipmapsAutoUpdate===!0&&v(he),be.__version=ve.version,A.onUpdate&&A.onUpdate(A)}P.__version=A.version}function gn(P,A,$){if(A.image.length!==6)return;let he=at(P,A),re=A.source;t.bindTexture(i.TEXTURE_CUBE_MAP,P.__webglTexture,i.TEXTURE0+$);let ve=n.get(re);if(re.version!==ve.__version||he===!0){t.activeTexture(i.TEXTURE0+$);let be=bt.getPrimaries(bt.workingColorSpace),te=A.colorSpace===ks?null:bt.getPrimaries(A.colorSpace),ie=A.colorSpace===ks||be===te?i.NONE:i.BROWSER_DEFAULT_WEBGL;t.pixelStorei(i.UNPACK_FLIP_Y_WEBGL,A.flipY),t.pixelStorei(i.UNPACK_PREMULTIPLY_ALPHA_WEBGL,A.premultiplyAlpha),t.pixelStorei(i.UNPACK_ALIGNMENT,A.unpackAlignment),t.pixelStorei(i.UNPACK_COLORSPACE_CONVERSION_WEBGL,ie);let pe=A.isCompressedTexture||A.image[0].isCompressedTexture,B=A.image[0]&&A.image[0].isDataTexture,se=[];for(let Ce=0;Ce<6;Ce++)!pe&&!B?se[Ce]=y(A.image[Ce],!0,s.maxCubemapSize):se[Ce]=B?A.image[Ce].image:A.image[Ce],se[Ce]=Ge(A,se[Ce]);let ne=se[0],Ae=r.convert(A.format,A.colorSpace),xe=r.convert(A.type),Se=S(A.internalFormat,Ae,xe,A.normalized,A.colorSpace),We=A.isVideoTexture!==!0,je=ve.__version===void 0||he===!0,ce=re.dataReady,Be=M(A,ne);it(i.TEXTURE_CUBE_MAP,A);let Qe;if(A.isDepthTexture){if(Se=_(A.format===Os,A.type),je)if(We)t.texStorage2D(i.TEXTURE_CUBE_MAP,1,Se,ne.width,ne.height);else for(let Ce=0;Ce<6;Ce++)t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,0,Se,ne.width,ne.height,0,Ae,xe,null)}else if(pe){We&&je&&t.texStorage2D(i.TEXTURE_CUBE_MAP,Be,Se,ne.width,ne.height);for(let Ce=0;Ce<6;Ce++){Qe=se[Ce].mipmaps;for(let lt=0;lt<Qe.length;lt++){let qt=Qe[lt];A.format!==Qi?Ae!==null?We?ce&&t.compressedTexSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt,0,0,qt.width,qt.height,Ae,qt.data):t.compressedTexImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt,Se,qt.width,qt.height,0,qt.data):Ye("WebGLRenderer: Attempt to load unsupported compressed texture format in .setTextureCube()"):We?ce&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt,0,0,qt.width,qt.height,Ae,xe,qt.data):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt,Se,qt.width,qt.height,0,Ae,xe,qt.data)}}}else{if(Qe=A.mipmaps,We&&je){Qe.length>0&&Be++;let Ce=$e(se[0]);t.texStorage2D(i.TEXTURE_CUBE_MAP,Be,Se,Ce.width,Ce.height)}for(let Ce=0;Ce<6;Ce++)if(B){We?ce&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,0,0,0,se[Ce].width,se[Ce].height,Ae,xe,se[Ce].data):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,0,Se,se[Ce].width,se[Ce].height,0,Ae,xe,se[Ce].data);for(let lt=0;lt<Qe.length;lt++){let ni=Qe[lt].image[Ce].image;We?ce&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt+1,0,0,ni.width,ni.height,Ae,xe,ni.data):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt+1,Se,ni.width,ni.height,0,Ae,xe,ni.data)}}else{We?ce&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,0,0,0,Ae,xe,se[Ce]):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,0,Se,Ae,xe,se[Ce]);for(let lt=0;lt<Qe.length;lt++){let qt=Qe[lt];We?ce&&t.texSubImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt+1,0,0,Ae,xe,qt.image[Ce]):t.texImage2D(i.TEXTURE_CUBE_MAP_POSITIVE_X+Ce,lt+1,Se,Ae,xe,qt.image[Ce])}}}w(A)&&A.mipmapsAutoUpdate===!0&&v(i.TEXTURE_CUBE_MAP),ve.__version=re.version,A.onUpdate&&A.onUpdate(A)}P.__version=A.version}function Bt(P,A,$,he,re,ve){let be=r.convert($.format,$.colorSpace),te=r.convert($.type),ie=S($.internalFormat,be,te,$.normalized,$.colorSpace),pe=n.get(A),B=n.get($);if(B.__renderTarget=A,!pe.__hasExternalTextures){let se=Math.max(1,A.width>>ve),ne=Math.max(1,A.height>>ve);re===i.TEXTURE_3D||re===i.TEXTURE_2D_ARRAY?t.texImage3D(re,ve,ie,se,ne,A.depth,0,be,te,null):t.texImage2D(re,ve,ie,se,ne,0,be,te,null)}t.bindFramebuffer(i.FRAMEBUFFER,P),we(A)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,he,re,B.__webglTexture,0,ot(A)):(re===i.TEXTURE_2D||re>=i.TEXTURE_CUBE_MAP_POSITIVE_X&&re<=i.TEXTURE_CUBE_MAP_NEGATIVE_Z)&&i.framebufferTexture2D(i.FRAMEBUFFER,he,re,B.__webglTexture,ve),t.bindFramebuffer(i.FRAMEBUFFER,null)}function Dn(P,A,$){if(i.bindRenderbuffer(i.RENDERBUFFER,P),A.depthBuffer){let he=A.depthTexture,re=he&&he.isDepthTexture?he.type:null,ve=_(A.stencilBuffer,re),be=A.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;we(A)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,ot(A),ve,A.width,A.height):$?i.renderbufferStorageMultisample(i.RENDERBUFFER,ot(A),ve,A.width,A.height):i.renderbufferStorage(i.RENDERBUFFER,ve,A.width,A.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,be,i.RENDERBUFFER,P)}else{let he=A.textures;for(let re=0;re<he.length;re++){let ve=he[re],be=r.convert(ve.format,ve.colorSpace),te=r.convert(ve.type),ie=S(ve.internalFormat,be,te,ve.normalized,ve.colorSpace);we(A)?a.renderbufferStorageMultisampleEXT(i.RENDERBUFFER,ot(A),ie,A.width,A.height):$?i.renderbufferStorageMultisample(i.RENDERBUFFER,ot(A),ie,A.width,A.height):i.renderbufferStorage(i.RENDERBUFFER,ie,A.width,A.height)}}i.bindRenderbuffer(i.RENDERBUFFER,null)}function St(P,A,$){let he=A.isWebGLCubeRenderTarget===!0;if(t.bindFramebuffer(i.FRAMEBUFFER,P),!(A.depthTexture&&A.depthTexture.isDepthTexture))throw new Error("THREE.WebGLTextures: renderTarget.depthTexture must be an instance of THREE.DepthTexture.");let re=n.get(A.depthTexture);re.__renderTarget=A;let ve=he?A.depthTexture.image[0]:A.depthTexture.image;(!re.__webglTexture||ve.width!==A.width||ve.height!==A.height)&&(ve.width=A.width,ve.height=A.height,A.depthTexture.needsUpdate=!0),he?ye(A.depthTexture,0):me(A.depthTexture,0);let be=re.__webglTexture,te=ot(A),ie=he?i.TEXTURE_CUBE_MAP_POSITIVE_X+$:i.TEXTURE_2D,pe=A.depthTexture.format===Os?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;if(A.depthTexture.format===Ls)we(A)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,pe,ie,be,0,te):i.framebufferTexture2D(i.FRAMEBUFFER,pe,ie,be,0);else if(A.depthTexture.format===Os)we(A)?a.framebufferTexture2DMultisampleEXT(i.FRAMEBUFFER,pe,ie,be,0,te):i.framebufferTexture2D(i.FRAMEBUFFER,pe,ie,be,0);else throw new Error("THREE.WebGLTextures: Unknown depthTexture format.")}function En(P){let A=n.get(P),$=P.isWebGLCubeRenderTarget===!0;if(A.__boundDepthTexture!==P.depthTexture){let he=P.depthTexture;if(A.__depthDisposeCallback&&A.__depthDisposeCallback(),he){let re=()=>{delete A.__boundDepthTexture,delete A.__depthDisposeCallback,he.removeEventListener("dispose",re)};he.addEventListener("dispose",re),A.__depthDisposeCallback=re}A.__boundDepthTexture=he}if(P.depthTexture&&!A.__autoAllocateDepthBuffer)if($)for(let he=0;he<6;he++)St(A.__webglFramebuffer[he],P,he);else P.texture.mipmaps.length>0?St(A.__webglFramebuffer[0],P,0):St(A.__webglFramebuffer,P,0);else if($){A.__webglDepthbuffer=[];for(let he=0;he<6;he++)if(t.bindFramebuffer(i.FRAMEBUFFER,A.__webglFramebuffer[he]),A.__webglDepthbuffer[he]===void 0)A.__webglDepthbuffer[he]=i.createRenderbuffer(),Dn(A.__webglDepthbuffer[he],P,!1);else{let re=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,ve=A.__webglDepthbuffer[he];i.bindRenderbuffer(i.RENDERBUFFER,ve),i.framebufferRenderbuffer(i.FRAMEBUFFER,re,i.RENDERBUFFER,ve)}}else if(P.texture.mipmaps.length>0?t.bindFramebuffer(i.FRAMEBUFFER,A.__webglFramebuffer[0]):t.bindFramebuffer(i.FRAMEBUFFER,A.__webglFramebuffer),A.__webglDepthbuffer===void 0)A.__webglDepthbuffer=i.createRenderbuffer(),Dn(A.__webglDepthbuffer,P,!1);else{let re=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,ve=A.__webglDepthbuffer;i.bindRenderbuffer(i.RENDERBUFFER,ve),i.framebufferRenderbuffer(i.FRAMEBUFFER,re,i.RENDERBUFFER,ve)}t.bindFramebuffer(i.FRAMEBUFFER,null)}function an(P,A,$){let he=n.get(P);A!==void 0&&Bt(he.__webglFramebuffer,P,P.texture,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,0),$!==void 0&&En(P)}function yn(P){let A=P.texture,$=n.get(P),he=n.get(A);P.addEventListener("dispose",k),D(P);let re=P.textures,ve=P.isWebGLCubeRenderTarget===!0,be=re.length>1;if(be||(he.__webglTexture===void 0&&(he.__webglTexture=i.createTexture()),he.__version=A.version,o.memory.textures++),ve){$.__webglFramebuffer=[];for(let te=0;te<6;te++)if(A.mipmaps.length>0){$.__webglFramebuffer[te]=[];for(let ie=0;ie<A.mipmaps.length;ie++)$.__webglFramebuffer[te][ie]=i.createFramebuffer()}else $.__webglFramebuffer[te]=i.createFramebuffer()}else{if(A.mipmaps.length>0){$.__webglFramebuffer=[];for(let te=0;te<A.mipmaps.length;te++)$.__webglFramebuffer[te]=i.createFramebuffer()}else $.__webglFramebuffer=i.createFramebuffer();if(be)for(let te=0,ie=re.length;te<ie;te++){let pe=n.get(re[te]);pe.__webglTexture===void 0&&(pe.__webglTexture=i.createTexture(),o.memory.textures++)}if(P.samples>0&&we(P)===!1){$.__webglMultisampledFramebuffer=i.createFramebuffer(),$.__webglColorRenderbuffer=[],t.bindFramebuffer(i.FRAMEBUFFER,$.__webglMultisampledFramebuffer);for(let te=0;te<re.length;te++){let ie=re[te];$.__webglColorRenderbuffer[te]=i.createRenderbuffer(),i.bindRenderbuffer(i.RENDERBUFFER,$.__webglColorRenderbuffer[te]);let pe=r.convert(ie.format,ie.colorSpace),B=r.convert(ie.type),se=S(ie.internalFormat,pe,B,ie.normalized,ie.colorSpace,P.isXRRenderTarget===!0),ne=ot(P);i.renderbufferStorageMultisample(i.RENDERBUFFER,ne,se,P.width,P.height),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+te,i.RENDERBUFFER,$.__webglColorRenderbuffer[te])}i.bindRenderbuffer(i.RENDERBUFFER,null),P.depthBuffer&&($.__webglDepthRenderbuffer=i.createRenderbuffer(),Dn($.__webglDepthRenderbuffer,P,!0)),t.bindFramebuffer(i.FRAMEBUFFER,null)}}if(ve){t.bindTexture(i.TEXTURE_CUBE_MAP,he.__webglTexture),it(i.TEXTURE_CUBE_MAP,A);for(let te=0;te<6;te++)if(A.mipmaps.length>0)for(let ie=0;ie<A.mipmaps.length;ie++)Bt($.__webglFramebuffer[te][ie],P,A,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+te,ie);else Bt($.__webglFramebuffer[te],P,A,i.COLOR_ATTACHMENT0,i.TEXTURE_CUBE_MAP_POSITIVE_X+te,0);w(A)?v(i.TEXTURE_CUBE_MAP):A.mipmaps.length>0&&i.texParameteri(i.TEXTURE_CUBE_MAP,i.TEXTURE_MAX_LEVEL,A.mipmaps.length-1),t.unbindTexture()}else if(be){for(let te=0,ie=re.length;te<ie;te++){let pe=re[te],B=n.get(pe),se=i.TEXTURE_2D;(P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(se=P.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),t.bindTexture(se,B.__webglTexture),it(se,pe),Bt($.__webglFramebuffer,P,pe,i.COLOR_ATTACHMENT0+te,se,0),w(pe)&&v(se)}t.unbindTexture()}else{let te=i.TEXTURE_2D;if((P.isWebGL3DRenderTarget||P.isWebGLArrayRenderTarget)&&(te=P.isWebGL3DRenderTarget?i.TEXTURE_3D:i.TEXTURE_2D_ARRAY),t.bindTexture(te,he.__webglTexture),it(te,A),A.mipmaps.length>0)for(let ie=0;ie<A.mipmaps.length;ie++)Bt($.__webglFramebuffer[ie],P,A,i.COLOR_ATTACHMENT0,te,ie);else Bt($.__webglFramebuffer,P,A,i.COLOR_ATTACHMENT0,te,0);w(A)?v(te):A.mipmaps.length>0&&i.texParameteri(te,i.TEXTURE_MAX_LEVEL,A.mipmaps.length-1),t.unbindTexture()}P.depthBuffer&&En(P)}function z(P){let A=P.textures;for(let $=0,he=A.length;$<he;$++){let re=A[$];if(w(re)&&re.mipmapsAutoUpdate===!0){let ve=E(P),be=n.get(re).__webglTexture;t.bindTexture(ve,be),v(ve),t.unbindTexture()}}}let Re=[];function Ze(P){if(P.samples>0){if(we(P)===!1){let A=P.textures,$=P.width,he=P.height,re=i.COLOR_BUFFER_BIT,ve=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT,be=n.get(P),te=A.length>1;if(te)for(let pe=0;pe<A.length;pe++)t.bindFramebuffer(i.FRAMEBUFFER,be.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+pe,i.RENDERBUFFER,null),t.bindFramebuffer(i.FRAMEBUFFER,be.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+pe,i.TEXTURE_2D,null,0);t.bindFramebuffer(i.READ_FRAMEBUFFER,be.__webglMultisampledFramebuffer),P.texture.mipmaps.length>0?t.bindFramebuffer(i.DRAW_FRAMEBUFFER,be.__webglFramebuffer[0]):t.bindFramebuffer(i.DRAW_FRAMEBUFFER,be.__webglFramebuffer);for(let pe=0;pe<A.length;pe++){if(P.resolveDepthBuffer&&(P.depthBuffer&&(re|=i.DEPTH_BUFFER_BIT),P.stencilBuffer&&P.resolveStencilBuffer&&(re|=i.STENCIL_BUFFER_BIT)),te){i.framebufferRenderbuffer(i.READ_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.RENDERBUFFER,be.__webglColorRenderbuffer[pe]);let B=n.get(A[pe]).__webglTexture;i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0,i.TEXTURE_2D,B,0)}i.blitFramebuffer(0,0,$,he,0,0,$,he,re,i.NEAREST),l===!0&&(Re.length=0,Re.push(i.COLOR_ATTACHMENT0+pe),P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&Re.push(ve),i.invalidateFramebuffer(i.READ_FRAMEBUFFER,Re))}if(t.bindFramebuffer(i.READ_FRAMEBUFFER,null),t.bindFramebuffer(i.DRAW_FRAMEBUFFER,null),te)for(let pe=0;pe<A.length;pe++){t.bindFramebuffer(i.FRAMEBUFFER,be.__webglMultisampledFramebuffer),i.framebufferRenderbuffer(i.FRAMEBUFFER,i.COLOR_ATTACHMENT0+pe,i.RENDERBUFFER,be.__webglColorRenderbuffer[pe]);let B=n.get(A[pe]).__webglTexture;t.bindFramebuffer(i.FRAMEBUFFER,be.__webglFramebuffer),i.framebufferTexture2D(i.DRAW_FRAMEBUFFER,i.COLOR_ATTACHMENT0+pe,i.TEXTURE_2D,B,0)}t.bindFramebuffer(i.DRAW_FRAMEBUFFER,be.__webglMultisampledFramebuffer)}else if(P.depthBuffer&&P.storeMultisampledDepthBuffer===!1&&l){let A=P.stencilBuffer?i.DEPTH_STENCIL_ATTACHMENT:i.DEPTH_ATTACHMENT;i.invalidateFramebuffer(i.DRAW_FRAMEBUFFER,[A])}}}function ot(P){return Math.min(s.maxSamples,P.samples)}function we(P){let A=n.get(P);return P.samples>0&&e.has("WEBGL_multisampled_render_to_texture")===!0&&A.__useRenderToTexture!==!1}function Gt(P){let A=o.render.frame;h.get(P)!==A&&(h.set(P,A),P.update())}function Ge(P,A){let $=P.colorSpace,he=P.format,re=P.type;return P.isCompressedTexture===!0||P.isVideoTexture===!0||$!==Ra&&$!==ks&&(bt.getTransfer($)===Dt?(he!==Qi||re!==pi)&&Ye("WebGLTextures: sRGB encoded textures have to use RGBAFormat and UnsignedByteType."):et("WebGLTextures: Unsupported texture color space:",$)),A}function $e(P){return typeof HTMLImageElement<"u"&&P instanceof HTMLImageElement?(c.width=P.naturalWidth||P.width,c.height=P.naturalHeight||P.height):typeof VideoFrame<"u"&&P instanceof VideoFrame?(c.width=P.displayWidth,c.height=P.displayHeight):(c.width=P.width,c.height=P.height),c}this.allocateTextureUnit=ue,this.resetTextureUnits=J,this.getTextureUnits=ee,this.setTextureUnits=fe,this.setTexture2D=me,this.setTexture2DArray=ge,this.setTexture3D=_e,this.setTextureCube=ye,this.rebindTextures=an,this.setupRenderTarget=yn,this.updateRenderTargetMipmap=z,this.updateMultisampleRenderTarget=Ze,this.setupDepthRenderbuffer=En,this.setupFrameBufferTexture=Bt,this.useMultisampledRTT=we,this.dispose=U}function HA(i,e){function t(n,s=ks){let r,o=bt.getTransfer(s);if(n===pi)return i.UNSIGNED_BYTE;if(n===nh)return i.UNSIGNED_SHORT_4_4_4_4;if(n===ih)return i.UNSIGNED_SHORT_5_5_5_1;if(n===nd)return i.UNSIGNED_INT_5_9_9_9_REV;if(n===id)return i.UNSIGNED_INT_10F_11F_11F_REV;if(n===ed)return i.BYTE;if(n===td)return i.SHORT;if(n===Go)return i.UNSIGNED_SHORT;if(n===th)return i.INT;if(n===Ki)return i.UNSIGNED_INT;if(n===Ji)return i.FLOAT;if(n===ji)return i.HALF_FLOAT;if(n===sd)return i.ALPHA;if(n===rd)return i.RGB;if(n===Qi)return i.RGBA;if(n===Ls)return i.DEPTH_COMPONENT;if(n===Os)return i.DEPTH_STENCIL;if(n===od)return i.RED;if(n===sh)return i.RED_INTEGER;if(n===hr)return i.RG;if(n===rh)return i.RG_INTEGER;if(n===oh)return i.RGBA_INTEGER;if(n===ja||n===Qa||n===el||n===tl)if(o===Dt)if(r=e.get("WEBGL_compressed_texture_s3tc_srgb"),r!==null){if(n===ja)return r.COMPRESSED_SRGB_S3TC_DXT1_EXT;if(n===Qa)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT1_EXT;if(n===el)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT3_EXT;if(n===tl)return r.COMPRESSED_SRGB_ALPHA_S3TC_DXT5_EXT}else return null;else if(r=e.get("WEBGL_compressed_texture_s3tc"),r!==null){if(n===ja)return r.COMPRESSED_RGB_S3TC_DXT1_EXT;if(n===Qa)return r.COMPRESSED_RGBA_S3TC_DXT1_EXT;if(n===el)return r.COMPRESSED_RGBA_S3TC_DXT3_EXT;if(n===tl)return r.COMPRESSED_RGBA_S3TC_DXT5_EXT}else return null;if(n===ah||n===lh||n===ch||n===hh)if(r=e.get("WEBGL_compressed_texture_pvrtc"),r!==null){if(n===ah)return r.COMPRESSED_RGB_PVRTC_4BPPV1_IMG;if(n===lh)return r.COMPRESSED_RGB_PVRTC_2BPPV1_IMG;if(n===ch)return r.COMPRESSED_RGBA_PVRTC_4BPPV1_IMG;if(n===hh)return r.COMPRESSED_RGBA_PVRTC_2BPPV1_IMG}else return null;if(n===uh||n===fh||n===dh||n===ph||n===mh||n===nl||n===gh)if(r=e.get("WEBGL_compressed_texture_etc"),r!==null){if(n===uh||n===fh)return o===Dt?r.COMPRESSED_SRGB8_ETC2:r.COMPRESSED_RGB8_ETC2;if(n===dh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ETC2_EAC:r.COMPRESSED_RGBA8_ETC2_EAC;if(n===ph)return r.COMPRESSED_R11_EAC;if(n===mh)return r.COMPRESSED_SIGNED_R11_EAC;if(n===nl)return r.COMPRESSED_RG11_EAC;if(n===gh)return r.COMPRESSED_SIGNED_RG11_EAC}else return null;if(n===yh||n===_h||n===xh||n===vh||n===bh||n===Mh||n===Sh||n===wh||n===Ah||n===Eh||n===Th||n===Ch||n===Rh||n===Ih)if(r=e.get("WEBGL_compressed_texture_astc"),r!==null){if(n===yh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_4x4_KHR:r.COMPRESSED_RGBA_ASTC_4x4_KHR;if(n===_h)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x4_KHR:r.COMPRESSED_RGBA_ASTC_5x4_KHR;if(n===xh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_5x5_KHR:r.COMPRESSED_RGBA_ASTC_5x5_KHR;if(n===vh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x5_KHR:r.COMPRESSED_RGBA_ASTC_6x5_KHR;if(n===bh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_6x6_KHR:r.COMPRESSED_RGBA_ASTC_6x6_KHR;if(n===Mh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x5_KHR:r.COMPRESSED_RGBA_ASTC_8x5_KHR;if(n===Sh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x6_KHR:r.COMPRESSED_RGBA_ASTC_8x6_KHR;if(n===wh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_8x8_KHR:r.COMPRESSED_RGBA_ASTC_8x8_KHR;if(n===Ah)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x5_KHR:r.COMPRESSED_RGBA_ASTC_10x5_KHR;if(n===Eh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x6_KHR:r.COMPRESSED_RGBA_ASTC_10x6_KHR;if(n===Th)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x8_KHR:r.COMPRESSED_RGBA_ASTC_10x8_KHR;if(n===Ch)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_10x10_KHR:r.COMPRESSED_RGBA_ASTC_10x10_KHR;if(n===Rh)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x10_KHR:r.COMPRESSED_RGBA_ASTC_12x10_KHR;if(n===Ih)return o===Dt?r.COMPRESSED_SRGB8_ALPHA8_ASTC_12x12_KHR:r.COMPRESSED_RGBA_ASTC_12x12_KHR}else return null;if(n===Ph||n===Lh||n===Dh)if(r=e.get("EXT_texture_compression_bptc"),r!==null){if(n===Ph)return o===Dt?r.COMPRESSED_SRGB_ALPHA_BPTC_UNORM_EXT:r.COMPRESSED_RGBA_BPTC_UNORM_EXT;if(n===Lh)return r.COMPRESSED_RGB_BPTC_SIGNED_FLOAT_EXT;if(n===Dh)return r.COMPRESSED_RGB_BPTC_UNSIGNED_FLOAT_EXT}else return null;if(n===Nh||n===Uh||n===il||n===Fh)if(r=e.get("EXT_texture_compression_rgtc"),r!==null){if(n===Nh)return r.COMPRESSED_RED_RGTC1_EXT;if(n===Uh)return r.COMPRESSED_SIGNED_RED_RGTC1_EXT;if(n===il)return r.COMPRESSED_RED_GREEN_RGTC2_EXT;if(n===Fh)return r.COMPRESSED_SIGNED_RED_GREEN_RGTC2_EXT}else return null;return n===Fr?i.UNSIGNED_INT_24_8:i[n]!==void 0?i[n]:null}return{convert:t}}var GA=`
void main() {

	gl_Position = vec4( position, 1.0 );

}`,WA=`
uniform sampler2DArray depthColor;
uniform float depthWidth;
uniform float depthHeight;

void main() {

	vec2 coord = vec2( gl_FragCoord.x / depthWidth, gl_FragCoord.y / depthHeight );

	if ( coord.x >= 1.0 ) {

		gl_FragDepth = texture( depthColor, vec3( coord.x - 1.0, coord.y, 1 ) ).r;

	} else {

		gl_FragDepth = texture( depthColor, vec3( coord.x, coord.y, 0 ) ).r;

	}

}`,Cd=class{constructor(){this.texture=null,this.mesh=null,this.depthNear=0,this.depthFar=0}init(e,t){if(this.texture===null){let n=new ka(e.texture);(e.depthNear!==t.depthNear||e.depthFar!==t.depthFar)&&(this.depthNear=e.depthNear,this.depthFar=e.depthFar),this.texture=n}}getMesh(e){if(this.texture!==null&&this.mesh===null){let t=e.cameras[0].viewport,n=new ps({vertexShader:GA,fragmentShader:WA,uniforms:{depthColor:{value:this.texture},depthWidth:{value:t.z},depthHeight:{value:t.w}}});this.mesh=new _t(new Va(20,20),n)}return this.mesh}reset(){this.texture=null,this.mesh=null}getDepthTexture(){return this.texture}},Rd=class extends Zi{constructor(e,t){super();let n=this,s=null,r=1,o=null,a="local-floor",l=1,c=null,h=null,u=null,f=null,p=null,g=null,x=typeof XRWebGLBinding<"u",m=new Cd,d={},y=t.getContextAttributes(),w=null,v=null,E=[],S=[],_=new qe,M=null,D=null,I=new ci;I.viewport=new nn;let L=new ci;L.viewport=new nn;let k=[I,L],V=new Kc,R=null,U=null;this.cameraAutoUpdate=!0,this.enabled=!1,this.isPresenting=!1,this.getController=function(Q){let me=E[Q];return me===void 0&&(me=new Oo,E[Q]=me),me.getTargetRaySpace()},this.getControllerGrip=function(Q){let me=E[Q];return me===void 0&&(me=new Oo,E[Q]=me),me.getGripSpace()},this.getHand=function(Q){let me=E[Q];return me===void 0&&(me=new Oo,E[Q]=me),me.getHandSpace()};function X(Q){let me=S.indexOf(Q.inputSource);if(me===-1)return;let ge=E[me];ge!==void 0&&(ge.update(Q.inputSource,Q.frame,c||o),ge.dispatchEvent({type:Q.type,data:Q.inputSource}))}function H(){s.removeEventListener("select",X),s.removeEventListener("selectstart",X),s.removeEventListener("selectend",X),s.removeEventListener("squeeze",X),s.removeEventListener("squeezestart",X),s.removeEventListener("squeezeend",X),s.removeEventListener("end",H),s.removeEventListener("inputsourceschange",ae);for(let Q=0;Q<E.length;Q++){let me=S[Q];me!==null&&(S[Q]=null,E[Q].disconnect(me))}R=null,U=null,m.reset();for(let Q in d)delete d[Q];if(e.setRenderTarget(w),p=null,f=null,u=null,s=null,v=null,ue.stop(),n.isPresenting=!1,e.setPixelRatio(M),e.setSize(_.width,_.height,!1),D!==null){let Q=D.camera;Q.fov=D.fov,Q.zoom=D.zoom,Q.updateProjectionMatrix(),D=null}n.dispatchEvent({type:"sessionend"})}this.setFramebufferScaleFactor=function(Q){r=Q,n.isPresenting===!0&&Ye("WebXRManager: Cannot change framebuffer scale while presenting.")},this.setReferenceSpaceType=function(Q){a=Q,n.isPresenting===!0&&Ye("WebXRManager: Cannot change reference space type while presenting.")},this.getReferenceSpace=function(){return c||o},this.setReferenceSpace=function(Q){c=Q},this.getBaseLayer=function(){return f!==null?f:p},this.getBinding=function(){return u===null&&x&&(u=new XRWebGLBinding(s,t)),u},this.getFrame=function(){return g},this.getSession=function(){return s},this.setSession=async function(Q){if(s=Q,s!==null){if(w=e.getRenderTarget(),s.addEventListener("select",X),s.addEventListener("selectstart",X),s.addEventListener("selectend",X),s.addEventListener("squeeze",X),s.addEventListener("squeezestart",X),s.addEventListener("squeezeend",X),s.addEventListener("end",H),s.addEventListener("inputsourceschange",ae),y.xrCompatible!==!0&&await t.makeXRCompatible(),M=e.getPixelRatio(),e.getSize(_),x&&"createProjectionLayer"in XRWebGLBinding.prototype){let ge=null,_e=null,ye=null;y.depth&&(ye=y.stencil?t.DEPTH24_STENCIL8:t.DEPTH_COMPONENT24,ge=y.stencil?Os:Ls,_e=y.stencil?Fr:Ki);let He={colorFormat:t.RGBA8,depthFormat:ye,scaleFactor:r};u=this.getBinding(),f=u.createProjectionLayer(He),s.updateRenderState({layers:[f]}),e.setPixelRatio(1),e.setSize(f.textureWidth,f.textureHeight,!1),v=new Ci(f.textureWidth,f.textureHeight,{format:Qi,type:pi,depthTexture:new Us(f.textureWidth,f.textureHeight,_e,void 0,void 0,void 0,void 0,void 0,void 0,ge),stencilBuffer:y.stencil,colorSpace:e.outputColorSpace,samples:y.antialias?4:0,resolveDepthBuffer:f.ignoreDepthValues===!1,resolveStencilBuffer:f.ignoreDepthValues===!1,storeMultisampledDepthBuffer:f.ignoreDepthValues===!1,storeMultisampledStencilBuffer:f.ignoreDepthValues===!1})}else{let ge={antialias:y.antialias,alpha:!0,depth:y.depth,stencil:y.stencil,framebufferScaleFactor:r};p=new XRWebGLLayer(s,t,ge),s.updateRenderState({baseLayer:p}),e.setPixelRatio(1),e.setSize(p.framebufferWidth,p.framebufferHeight,!1),v=new Ci(p.framebufferWidth,p.framebufferHeight,{format:Qi,type:pi,colorSpace:e.outputColorSpace,stencilBuffer:y.stencil,resolveDepthBuffer:p.ignoreDepthValues===!1,resolveStencilBuffer:p.ignoreDepthValues===!1,storeMultisampledDepthBuffer:p.ignoreDepthValues===!1,storeMultisampledStencilBuffer:p.ignoreDepthValues===!1})}v.isXRRenderTarget=!0,this.setFoveation(l),c=null,o=await s.requestReferenceSpace(a),ue.setContext(s),ue.start(),n.isPresenting=!0,n.dispatchEvent({type:"sessionstart"})}},this.getEnvironmentBlendMode=function(){if(s!==null)return s.environmentBlendMode},this.getDepthTexture=function(){return m.getDepthTexture()};function ae(Q){for(let me=0;me<Q.removed.length;me++){let ge=Q.removed[me],_e=S.indexOf(ge);_e>=0&&(S[_e]=null,E[_e].disconnect(ge))}for(let me=0;me<Q.added.length;me++){let ge=Q.added[me],_e=S.indexOf(ge);if(_e===-1){for(let He=0;He<E.length;He++)if(He>=S.length){S.push(ge),_e=He;break}else if(S[He]===null){S[He]=ge,_e=He;break}if(_e===-1)break}let ye=E[_e];ye&&ye.connect(ge)}}function Y(Q,me){me===null?Q.matrixWorld.copy(Q.matrix):Q.matrixWorld.multiplyMatrices(me.matrixWorld,Q.matrix),Q.matrixWorldInverse.copy(Q.matrixWorld).invert()}this.updateCamera=function(Q){if(s===null)return;let me=Q.near,ge=Q.far;m.texture!==null&&(m.depthNear>0&&(me=m.depthNear),m.depthFar>0&&(ge=m.depthFar)),V.near=L.near=I.near=me,V.far=L.far=I.far=ge,(R!==V.near||U!==V.far)&&(s.updateRenderState({depthNear:V.near,depthFar:V.far}),R=V.near,U=V.far),V.layers.mask=Q.layers.mask|6,I.layers.mask=V.layers.mask&-5,L.layers.mask=V.layers.mask&-3;let _e=Q.parent,ye=V.cameras;Y(V,_e);for(let He=0;He<ye.length;He++)Y(ye[He],_e);V.projectionMatrix.copy(I.projectionMatrix),V.projectionMatrixInverse.copy(I.projectionMatrixInverse),D===null&&Q.isPerspectiveCamera&&(D={camera:Q,fov:Q.fov,zoom:Q.zoom}),J(Q,V,_e)};function J(Q,me,ge){ge===null?Q.matrix.copy(me.matrixWorld):(Q.matrix.copy(ge.matrixWorld),Q.matrix.invert(),Q.matrix.multiply(me.matrixWorld)),Q.matrix.decompose(Q.position,Q.quaternion,Q.scale),Q.updateMatrixWorld(!0),Q.projectionMatrix.copy(me.projectionMatrix),Q.projectionMatrixInverse.copy(me.projectionMatrixInverse),Q.isPerspectiveCamera&&(Q.fov=No*2*Math.atan(1/Q.projectionMatrix.elements[5]),Q.zoom=1)}this.getCamera=function(){return V},this.getFoveation=function(){if(!(f===null&&p===null))return l},this.setFoveation=function(Q){l=Q,f!==null&&(f.fixedFoveation=Q),p!==null&&p.fixedFoveation!==void 0&&(p.fixedFoveation=Q)},this.hasDepthSensing=function(){return m.texture!==null},this.getDepthSensingMesh=function(){return m.getMesh(V)},this.getCameraTexture=function(Q){return d[Q]};let ee=null;function fe(Q,me){if(h=me.getViewerPose(c||o),g=me,h!==null){let ge=h.views;p!==null&&(e.setRenderTargetFramebuffer(v,p.framebuffer),e.setRenderTarget(v));let _e=!1;ge.length!==V.cameras.length&&(V.cameras.length=0,_e=!0);for(let Oe=0;Oe<ge.length;Oe++){let it=ge[Oe],at=null;if(p!==null)at=p.getViewport(it);else{let Qt=u.getViewSubImage(f,it);at=Qt.viewport,Oe===0&&(e.setRenderTargetTextures(v,Qt.colorTexture,Qt.depthStencilTexture),e.setRenderTarget(v))}let st=k[Oe];st===void 0&&(st=new ci,st.layers.enable(Oe),st.viewport=new nn,k[Oe]=st),st.matrix.fromArray(it.transform.matrix),st.matrix.decompose(st.position,st.quaternion,st.scale),st.projectionMatrix.fromArray(it.projectionMatrix),st.projectionMatrixInverse.copy(st.projectionMatrix).invert(),st.viewport.set(at.x,at.y,at.width,at.height),Oe===0&&(V.matrix.copy(st.matrix),V.matrix.decompose(V.position,V.quaternion,V.scale)),_e===!0&&V.cameras.push(st)}let ye=s.enabledFeatures;if(ye&&ye.includes("depth-sensing")&&s.depthUsage=="gpu-optimized"&&x){u=n.getBinding();let Oe=u.getDepthInformation(ge[0]);Oe&&Oe.isValid&&Oe.texture&&m.init(Oe,s.renderState)}if(ye&&ye.includes("camera-access")&&x){e.state.unbindTexture(),u=n.getBinding();for(let Oe=0;Oe<ge.length;Oe++){let it=ge[Oe].camera;if(it){let at=d[it];at||(at=new ka,d[it]=at);let st=u.getCameraImage(it);at.sourceTexture=st}}}}for(let ge=0;ge<E.length;ge++){let _e=S[ge],ye=E[ge];_e!==null&&ye!==void 0&&ye.update(_e,me,c||o)}ee&&ee(Q,me),me.detectedPlanes&&n.dispatchEvent({type:"planesdetected",data:me}),g=null}let ue=new j0;ue.setAnimationLoop(fe),this.setAnimationLoop=function(Q){ee=Q},this.dispose=function(){}}},XA=new Vt,ly=new nt;ly.set(-1,0,0,0,1,0,0,0,1);function $A(i,e){function t(m,d){m.matrixAutoUpdate===!0&&m.updateMatrix(),d.value.copy(m.matrix)}function n(m,d){d.color.getRGB(m.fogColor.value,gd(i)),d.isFog?(m.fogNear.value=d.near,m.fogFar.value=d.far):d.isFogExp2&&(m.fogDensity.value=d.density)}function s(m,d,y,w,v){d.isNodeMaterial?d.uniformsNeedUpdate=!1:d.isMeshBasicMaterial?r(m,d):d.isMeshLambertMaterial?(r(m,d),d.envMap&&(m.envMapIntensity.value=d.envMapIntensity)):d.isMeshToonMaterial?(r(m,d),u(m,d)):d.isMeshPhongMaterial?(r(m,d),h(m,d),d.envMap&&(m.envMapIntensity.value=d.envMapIntensity)):d.isMeshStandardMaterial?(r(m,d),f(m,d),d.isMeshPhysicalMaterial&&p(m,d,v)):d.isMeshMatcapMaterial?(r(m,d),g(m,d)):d.isMeshDepthMaterial?r(m,d):d.isMeshDistanceMaterial?(r(m,d),x(m,d)):d.isMeshNormalMaterial?r(m,d):d.isLineBasicMaterial?(o(m,d),d.isLineDashedMaterial&&a(m,d)):d.isPointsMaterial?l(m,d,y,w):d.isSpriteMaterial?c(m,d):d.isShadowMaterial?(m.color.value.copy(d.color),m.opacity.value=d.opacity):d.isShaderMaterial&&(d.uniformsNeedUpdate=!1)}function r(m,d){m.opacity.value=d.opacity,d.color&&m.diffuse.value.copy(d.color),d.emissive&&m.emissive.value.copy(d.emissive).multiplyScalar(d.emissiveIntensity),d.map&&(m.map.value=d.map,t(d.map,m.mapTransform)),d.alphaMap&&(m.alphaMap.value=d.alphaMap,t(d.alphaMap,m.alphaMapTransform)),d.bumpMap&&(m.bumpMap.value=d.bumpMap,t(d.bumpMap,m.bumpMapTransform),m.bumpScale.value=d.bumpScale,d.side===ui&&(m.bumpScale.value*=-1)),d.normalMap&&(m.normalMap.value=d.normalMap,t(d.normalMap,m.normalMapTransform),m.normalScale.value.copy(d.normalScale),d.side===ui&&m.normalScale.value.negate()),d.displacementMap&&(m.displacementMap.value=d.displacementMap,t(d.displacementMap,m.displacementMapTransform),m.displacementScale.value=d.displacementScale,m.displacementBias.value=d.displacementBias),d.emissiveMap&&(m.emissiveMap.value=d.emissiveMap,t(d.emissiveMap,m.emissiveMapTransform)),d.specularMap&&(m.specularMap.value=d.specularMap,t(d.specularMap,m.specularMapTransform)),d.alphaTest>0&&(m.alphaTest.value=d.alphaTest);let y=e.get(d),w=y.envMap,v=y.envMapRotation;w&&(m.envMap.value=w,m.envMapRotation.value.setFromMatrix4(XA.makeRotationFromEuler(v)).transpose(),w.isCubeTexture&&w.isRenderTargetTexture===!1&&m.envMapRotation.value.premultiply(ly),m.reflectivity.value=d.reflectivity,m.ior.value=d.ior,m.refractionRatio.value=d.refractionRatio),d.lightMap&&(m.lightMap.value=d.lightMap,m.lightMapIntensity.value=d.lightMapIntensity,t(d.lightMap,m.lightMapTransform)),d.aoMap&&(m.aoMap.value=d.aoMap,m.aoMapIntensity.value=d.aoMapIntensity,t(d.aoMap,m.aoMapTransform))}function o(m,d){m.diffuse.value.copy(d.color),m.opacity.value=d.opacity,d.map&&(m.map.value=d.map,t(d.map,m.mapTransform))}function a(m,d){m.dashSize.value=d.dashSize,m.totalSize.value=d.dashSize+d.gapSize,m.scale.value=d.scale}function l(m,d,y,w){m.diffuse.value.copy(d.color),m.opacity.value=d.opacity,m.size.value=d.size*y,m.scale.value=w*.5,d.map&&(m.map.value=d.map,t(d.map,m.uvTransform)),d.alphaMap&&(m.alphaMap.value=d.alphaMap,t(d.alphaMap,m.alphaMapTransform)),d.alphaTest>0&&(m.alphaTest.value=d.alphaTest)}function c(m,d){m.diffuse.value.copy(d.color),m.opacity.value=d.opacity,m.rotation.value=d.rotation,d.map&&(m.map.value=d.map,t(d.map,m.mapTransform)),d.alphaMap&&(m.alphaMap.value=d.alphaMap,t(d.alphaMap,m.alphaMapTransform)),d.alphaTest>0&&(m.alphaTest.value=d.alphaTest)}function h(m,d){m.specular.value.copy(d.specular),m.shininess.value=Math.max(d.shininess,1e-4)}function u(m,d){d.gradientMap&&(m.gradientMap.value=d.gradientMap)}function f(m,d){m.metalness.value=d.metalness,d.metalnessMap&&(m.metalnessMap.value=d.metalnessMap,t(d.metalnessMap,m.metalnessMapTransform)),m.roughness.value=d.roughness,d.roughnessMap&&(m.roughnessMap.value=d.roughnessMap,t(d.roughnessMap,m.roughnessMapTransform)),d.envMap&&(m.envMapIntensity.value=d.envMapIntensity)}function p(m,d,y){m.ior.value=d.ior,d.diffuseRoughness>0&&(m.diffuseRoughness.value=d.diffuseRoughness,d.diffuseRoughnessMap&&(m.diffuseRoughnessMap.value=d.diffuseRoughnessMap,t(d.diffuseRoughnessMap,m.diffuseRoughnessMapTransform))),d.sheen>0&&(m.sheenColor.value.copy(d.sheenColor).multiplyScalar(d.sheen),m.sheenRoughness.value=d.sheenRoughness,d.sheenColorMap&&(m.sheenColorMap.value=d.sheenColorMap,t(d.sheenColorMap,m.sheenColorMapTransform)),d.sheenRoughnessMap&&(m.sheenRoughnessMap.value=d.sheenRoughnessMap,t(d.sheenRoughnessMap,m.sheenRoughnessMapTransform))),d.clearcoat>0&&(m.clearcoat.value=d.clearcoat,m.clearcoatRoughness.value=d.clearcoatRoughness,d.clearcoatMap&&(m.clearcoatMap.value=d.clearcoatMap,t(d.clearcoatMap,m.clearcoatMapTransform)),d.clearcoatRoughnessMap&&(m.clearcoatRoughnessMap.value=d.clearcoatRoughnessMap,t(d.clearcoatRoughnessMap,m.clearcoatRoughnessMapTransform)),d.clearcoatNormalMap&&(m.clearcoatNormalMap.value=d.clearcoatNormalMap,t(d.clearcoatNormalMap,m.clearcoatNormalMapTransform),m.clearcoatNormalScale.value.copy(d.clearcoatNormalScale),d.side===ui&&m.clearcoatNormalScale.value.negate())),d.dispersion>0&&(m.dispersion.value=d.dispersion),d.retroreflectivity>0&&(m.retroreflectivity.value=d.retroreflectivity),d.iridescence>0&&(m.iridescence.value=d.iridescence,m.iridescenceIOR.value=d.iridescenceIOR,m.iridescenceThicknessMinimum.value=d.iridescenceThicknessMinimum,m.iridescenceThicknessMaximum.value=d.iridescenceThicknessMaximum,d.iridescenceMap&&(m.iridescenceMap.value=d.iridescenceMap,t(d.iridescenceMap,m.iridescenceMapTransform)),d.iridescenceThicknessMap&&(m.iridescenceThicknessMap.value=d.iridescenceThicknessMap,t(d.iridescenceThicknessMap,m.iridescenceThicknessMapTransform))),d.transmission>0&&(m.transmission.value=d.transmission,m.transmissionSamplerMap.value=y.texture,m.transmissionSamplerSize.value.set(y.width,y.height),d.transmissionMap&&(m.transmissionMap.value=d.transmissionMap,t(d.transmissionMap,m.transmissionMapTransform)),m.thickness.value=d.thickness,d.thicknessMap&&(m.thicknessMap.value=d.thicknessMap,t(d.thicknessMap,m.thicknessMapTransform)),m.attenuationDistance.value=d.attenuationDistance,m.attenuationColor.value.copy(d.attenuationColor)),d.anisotropy>0&&(m.anisotropyVector.value.set(d.anisotropy*Math.cos(d.anisotropyRotation),d.anisotropy*Math.sin(d.anisotropyRotation)),d.anisotropyMap&&(m.anisotropyMap.value=d.anisotropyMap,t(d.anisotropyMap,m.anisotropyMapTransform))),m.specularIntensity.value=d.specularIntensity,m.specularColor.value.copy(d.specularColor),d.specularColorMap&&(m.specularColorMap.value=d.specularColorMap,t(d.specularColorMap,m.specularColorMapTransform)),d.specularIntensityMap&&(m.specularIntensityMap.value=d.specularIntensityMap,t(d.specularIntensityMap,m.specularIntensityMapTransform))}function g(m,d){d.matcap&&(m.matcap.value=d.matcap)}function x(m,d){let y=e.get(d).light;m.referencePosition.value.setFromMatrixPosition(y.matrixWorld),m.nearDistance.value=y.shadow.camera.near,m.farDistance.value=y.shadow.camera.far}return{refreshFogUniforms:n,refreshMaterialUniforms:s}}function qA(i,e,t,n){let s={},r={};function o(y,w){let v=w.program;n.uniformBlockBinding(y,v,s[y.id])}function a(y,w){let v=s[y.id];v===void 0&&(g(y),v=l(y),s[y.id]=v,y.addEventListener("dispose",m));let E=w.program;n.updateUBOMapping(y,E);let S=e.render.frame;r[y.id]!==S&&(c(y),r[y.id]=S)}function l(y){let w=i.createBuffer(),v=y.__size,E=y.usage;return i.bindBuffer(i.UNIFORM_BUFFER,w),i.bufferData(i.UNIFORM_BUFFER,v,E),i.bindBuffer(i.UNIFORM_BUFFER,null),w}function c(y){let w=s[y.id],v=y.uniforms,E=y.__cache;i.bindBuffer(i.UNIFORM_BUFFER,w);for(let S=0,_=v.length;S<_;S++){let M=v[S];if(Array.isArray(M))for(let D=0,I=M.length;D<I;D++)h(M[D],S,D,E);else h(M,S,0,E)}i.bindBuffer(i.UNIFORM_BUFFER,null)}function h(y,w,v,E){if(f(y,w,v,E)===!0){let S=y.__offset,_=y.value;if(Array.isArray(_)){let M=0;for(let D=0;D<_.length;D++){let I=_[D],L=x(I,!0);u(I,y.__data,M),M+=L.storage/Float32Array.BYTES_PER_ELEMENT}}else u(_,y.__data,0);i.bufferSubData(i.UNIFORM_BUFFER,S,y.__data)}}function u(y,w,v){typeof y=="number"||typeof y=="boolean"?w[v]=y:y.isMatrix3?(w[v]=y.elements[0],w[v+1]=y.elements[1],w[v+2]=y.elements[2],w[v+3]=0,w[v+4]=y.elements[3],w[v+5]=y.elements[4],w[v+6]=y.elements[5],w[v+7]=0,w[v+8]=y.elements[6],w[v+9]=y.elements[7],w[v+10]=y.elements[8],w[v+11]=0):ArrayBuffer.isView(y)?w.set(y.subarray(0,w.length-v),v):y.toArray(w,v)}function f(y,w,v,E){let S=y.value,_=w+"_"+v;if(Array.isArray(S)){E[_]===void 0&&(E[_]=[]);let M=E[_],D=!1;for(let I=0;I<S.length;I++)p(S[I],M,I)===!0&&(D=!0);return D}return p(S,E,_)}function p(y,w,v){if(w[v]===void 0)return typeof y=="number"||typeof y=="boolean"?w[v]=y:ArrayBuffer.isView(y)?w[v]=y.slice():w[v]=y.clone(),!0;{let E=w[v];if(typeof y=="number"||typeof y=="boolean"){if(E!==y)return w[v]=y,!0}else{if(ArrayBuffer.isView(y))return!0;if(E.equals(y)===!1)return E.copy(y),!0}}return!1}function g(y){let w=y.uniforms,v=0,E=16;for(let _=0,M=w.length;_<M;_++){let D=Array.isArray(w[_])?w[_]:[w[_]];for(let I=0,L=D.length;I<L;I++){let k=D[I],V=Array.isArray(k.value)?k.value:[k.value],R=Array.isArray(w[_])||Array.isArray(k.value),U=v;for(let H=0,ae=V.length;H<ae;H++){let Y=V[H],J=x(Y,R),ee=v%E,fe=ee%J.boundary,ue=ee+fe;v+=fe,ue!==0&&E-ue<J.storage&&(v+=E-ue),H===0&&(U=v),v+=J.storage}let X=k.type==="int"?Int32Array:k.type==="uint"?Uint32Array:Float32Array;k.__data=new X((v-U)/Float32Array.BYTES_PER_ELEMENT),k.__offset=U}}let S=v%E;return S>0&&(v+=E-S),y.__size=v,y.__cache={},this}function x(y,w){let v={boundary:0,storage:0};return typeof y=="number"||typeof y=="boolean"?(v.boundary=4,v.storage=4):y.isVector2?(v.boundary=8,v.storage=8):y.isVector3||y.isColor?(v.boundary=16,v.storage=12):y.isVector4?(v.boundary=16,v.storage=16):y.isMatrix3?(v.boundary=16,v.storage=48):y.isMatrix4?(v.boundary=16,v.storage=64):y.isTexture?Ye("WebGLRenderer: Texture samplers can not be part of an uniforms group."):ArrayBuffer.isView(y)?(v.boundary=16,v.storage=y.byteLength):Ye("WebGLRenderer: Unsupported uniform value type.",y),w===!0&&(v.boundary=16,v.storage=Math.ceil(v.storage/16)*16),v}function m(y){let w=y.target;w.removeEventListener("dispose",m),i.deleteBuffer(s[w.id]),delete s[w.id],delete r[w.id]}function d(){for(let y in s)i.deleteBuffer(s[y]);s={},r={}}return{bind:o,update:a,dispose:d}}var YA=new Uint16Array([12469,15057,12620,14925,13266,14620,13807,14376,14323,13990,14545,13625,14713,13328,14840,12882,14931,12528,14996,12233,15039,11829,15066,11525,15080,11295,15085,10976,15082,10705,15073,10495,13880,14564,13898,14542,13977,14430,14158,14124,14393,13732,14556,13410,14702,12996,14814,12596,14891,12291,14937,11834,14957,11489,14958,11194,14943,10803,14921,10506,14893,10278,14858,9960,14484,14039,14487,14025,14499,13941,14524,13740,14574,13468,14654,13106,14743,12678,14818,12344,14867,11893,14889,11509,14893,11180,14881,10751,14852,10428,14812,10128,14765,9754,14712,9466,14764,13480,14764,13475,14766,13440,14766,13347,14769,13070,14786,12713,14816,12387,14844,11957,14860,11549,14868,11215,14855,10751,14825,10403,14782,10044,14729,9651,14666,9352,14599,9029,14967,12835,14966,12831,14963,12804,14954,12723,14936,12564,14917,12347,14900,11958,14886,11569,14878,11247,14859,10765,14828,10401,14784,10011,14727,9600,14660,9289,14586,8893,14508,8533,15111,12234,15110,12234,15104,12216,15092,12156,15067,12010,15028,11776,14981,11500,14942,11205,14902,10752,14861,10393,14812,9991,14752,9570,14682,9252,14603,8808,14519,8445,14431,8145,15209,11449,15208,11451,15202,11451,15190,11438,15163,11384,15117,11274,15055,10979,14994,10648,14932,10343,14871,9936,14803,9532,14729,9218,14645,8742,14556,8381,14461,8020,14365,7603,15273,10603,15272,10607,15267,10619,15256,10631,15231,10614,15182,10535,15118,10389,15042,10167,14963,9787,14883,9447,14800,9115,14710,8665,14615,8318,14514,7911,14411,7507,14279,7198,15314,9675,15313,9683,15309,9712,15298,9759,15277,9797,15229,9773,15166,9668,15084,9487,14995,9274,14898,8910,14800,8539,14697,8234,14590,7790,14479,7409,14367,7067,14178,6621,15337,8619,15337,8631,15333,8677,15325,8769,15305,8871,15264,8940,15202,8909,15119,8775,15022,8565,14916,8328,14804,8009,14688,7614,14569,7287,14448,6888,14321,6483,14088,6171,15350,7402,15350,7419,15347,7480,15340,7613,15322,7804,15287,7973,15229,8057,15148,8012,15046,7846,14933,7611,14810,7357,14682,7069,14552,6656,14421,6316,14251,5948,14007,5528,15356,5942,15356,5977,15353,6119,15348,6294,15332,6551,15302,6824,15249,7044,15171,7122,15070,7050,14949,6861,14818,6611,14679,6349,14538,6067,14398,5651,14189,5311,13935,4958,15359,4123,15359,4153,15356,4296,15353,4646,15338,5160,15311,5508,15263,5829,15188,6042,15088,6094,14966,6001,14826,5796,14678,5543,14527,5287,14377,4985,14133,4586,13869,4257,15360,1563,15360,1642,15358,2076,15354,2636,15341,3350,15317,4019,15273,4429,15203,4732,15105,4911,14981,4932,14836,4818,14679,4621,14517,4386,14359,4156,14083,3795,13808,3437,15360,122,15360,137,15358,285,15355,636,15344,1274,15322,2177,15281,2765,15215,3223,15120,3451,14995,3569,14846,3567,14681,3466,14511,3305,14344,3121,14037,2800,13753,2467,15360,0,15360,1,15359,21,15355,89,15346,253,15325,479,15287,796,15225,1148,15133,1492,15008,1749,14856,1882,14685,1886,14506,1783,14324,1608,13996,1398,13702,1183]),gs=null;function ZA(){return gs===null&&(gs=new Pc(YA,16,16,hr,ji),gs.name="DFG_LUT",gs.minFilter=hi,gs.magFilter=hi,gs.wrapS=fs,gs.wrapT=fs,gs.generateMipmaps=!1,gs.needsUpdate=!0),gs}var Vh=class{constructor(e={}){let{canvas:t=b0(),context:n=null,depth:s=!0,stencil:r=!1,alpha:o=!1,antialias:a=!1,premultipliedAlpha:l=!0,preserveDrawingBuffer:c=!1,powerPreference:h="default",failIfMajorPerformanceCaveat:u=!1,reversedDepthBuffer:f=!1,outputBufferType:p=pi}=e;this.isWebGLRenderer=!0;let g;if(n!==null){if(typeof WebGLRenderingContext<"u"&&n instanceof WebGLRenderingContext)throw new Error("THREE.WebGLRenderer: WebGL 1 is not supported since r163.");g=n.getContextAttributes().alpha}else g=o;let x=p,m=new Set([oh,rh,sh]),d=new Set([pi,Ki,Go,Fr,nh,ih]),y=new Uint32Array(4),w=new Int32Array(4),v={textures:[],min:[],max:[],resolution:[]},E=null,S=null,_=[],M=[],D=null;this.domElement=t,this.debug={checkShaderErrors:!0,diagnostics:{keywords:!1},onShaderError:null},this.autoClear=!0,this.autoClearColor=!0,this.autoClearDepth=!0,this.autoClearStencil=!0,this.sortObjects=!0,this.clippingPlanes=[],this.localClippingEnabled=!1,this.toneMapping=ms,this.toneMappingExposure=1,this.transmissionResolutionScale=1;let I=this,L=!1,k=null,V=null,R=null,U=null;this._outputColorSpace=Ti;let X=0,H=0,ae=null,Y=-1,J=null,ee=new nn,fe=new nn,ue=null,Q=new dt(0),me=0,ge=t.width,_e=t.height,ye=1,He=null,Ke=null,Oe=new nn(0,0,ge,_e),it=new nn(0,0,ge,_e),at=!1,st=new er,Qt=new Lc,$t=!1,gn=!1,Bt=new Vt,Dn=new O,St=new nn,En={background:null,fog:null,environment:null,overrideMaterial:null,isScene:!0},an=!1;function yn(){return ae===null?ye:1}let z=n;function Re(C,G){return t.getContext(C,G)}let Ze,ot,we,Gt,Ge,$e,P,A,$,he,re,ve,be,te,ie,pe,B,se,ne,Ae,xe,Se,We;try{let C={alpha:!0,depth:s,stencil:r,antialias:a,premultipliedAlpha:l,preserveDrawingBuffer:c,powerPreference:h,failIfMajorPerformanceCaveat:u};if("setAttribute"in t&&t.setAttribute("data-engine",`three.js r${"187"}`),t.addEventListener("webglcontextlost",Be,!1),t.addEventListener("webglcontextrestored",Qe,!1),t.addEventListener("webglcontextcreationerror",Ce,!1),z===null){let G="webgl2";if(z=Re(G,C),z===null)throw Re(G)?new Error("THREE.WebGLRenderer: Error creating WebGL context with your selected attributes."):new Error("THREE.WebGLRenderer: Error creating WebGL context.")}je()}catch(C){throw t.removeEventListener("webglcontextlost",Be,!1),t.removeEventListener("webglcontextrestored",Qe,!1),t.removeEventListener("webglcontextcreationerror",Ce,!1),et("WebGLRenderer: "+C.message),C}function je(){Ze=new o1(z),Ze.init(),xe=new HA(z,Ze),ot=new Zw(z,Ze,e,xe),we=new zA(z,Ze),ot.reversedDepthBuffer&&f&&we.buffers.depth.setReversed(!0),V=z.createFramebuffer(),R=z.createFramebuffer(),U=z.createFramebuffer(),Gt=new c1(z),Ge=new EA,$e=new VA(z,Ze,we,Ge,ot,xe,Gt),P=new r1(I),A=new uM(z),Se=new qw(z,A),$=new a1(z,A,Gt,Se),he=new u1(z,$,A,Se,Gt),se=new h1(z,ot,$e),ie=new Kw(Ge),re=new AA(I,P,Ze,ot,Se,ie),ve=new $A(I,Ge),be=new CA,te=new NA(Ze),B=new $w(I,P,we,he,g,l),pe=new BA(I,he,ot),We=new qA(z,Gt,ot,we),ne=new Yw(z,Ze,Gt),Ae=new l1(z,Ze,Gt),Gt.programs=re.programs,I.capabilities=ot,I.extensions=Ze,I.properties=Ge,I.renderLists=be,I.shadowMap=pe,I.state=we,I.info=Gt}x!==pi&&(D=new d1(x,t.width,t.height,a,s,r));let ce=new Rd(I,z);this.xr=ce,this.getContext=function(){return z},this.getContextAttributes=function(){return z.getContextAttributes()},this.forceContextLoss=function(){let C=Ze.get("WEBGL_lose_context");C&&C.loseContext()},this.forceContextRestore=function(){let C=Ze.get("WEBGL_lose_context");C&&C.restoreContext()},this.getPixelRatio=function(){return ye},this.setPixelRatio=function(C){C!==void 0&&(ye=C,this.setSize(ge,_e,!1))},this.getSize=function(C){return C.set(ge,_e)},this.setSize=function(C,G,j=!0){if(ce.isPresenting){Ye("WebGLRenderer: Can't change size while VR device is presenting.");return}ge=C,_e=G,t.width=Math.floor(C*ye),t.height=Math.floor(G*ye),j===!0&&(t.style.width=C+"px",t.style.height=G+"px"),D!==null&&D.setSize(t.width,t.height),this.setViewport(0,0,C,G)},this.getDrawingBufferSize=function(C){return C.set(ge*ye,_e*ye).floor()},this.setDrawingBufferSize=function(C,G,j){ge=C,_e=G,ye=j,t.width=Math.floor(C*j),t.height=Math.floor(G*j),this.setViewport(0,0,C,G)},this.setEffects=function(C){if(x===pi){et("WebGLRenderer: setEffects() requires outputBufferType set to HalfFloatType or FloatType.");return}if(C){for(let G=0;G<C.length;G++)if(C[G].isOutputPass===!0){Ye("WebGLRenderer: OutputPass is not needed in setEffects(). Tone mapping and color space conversion are applied automatically.");break}}D.setEffects(C||[])},this.getCurrentViewport=function(C){return C.copy(ee)},this.getViewport=function(C){return C.copy(Oe)},this.setViewport=function(C,G,j,q){C.isVector4?Oe.set(C.x,C.y,C.z,C.w):Oe.set(C,G,j,q),we.viewport(ee.copy(Oe).multiplyScalar(yn()).round())},this.getScissor=function(C){return C.copy(it)},this.setScissor=function(C,G,j,q){C.isVector4?it.set(C.x,C.y,C.z,C.w):it.set(C,G,j,q),we.scissor(fe.copy(it).multiplyScalar(yn()).round())},this.getScissorTest=function(){return at},this.setScissorTest=function(C){we.setScissorTest(at=C)},this.setOpaqueSort=function(C){He=C},this.setTransparentSort=function(C){Ke=C},this.getClearColor=function(C){return C.copy(B.getClearColor())},this.setClearColor=function(){B.setClearColor(...arguments)},this.getClearAlpha=function(){return B.getClearAlpha()},this.setClearAlpha=function(){B.setClearAlpha(...arguments)},this.clear=function(C=!0,G=!0,j=!0){let q=0;if(C){let Z=!1;if(ae!==null){let Ee=ae.texture.format;Z=m.has(Ee)}if(Z){let Ee=ae.texture.type,Ie=d.has(Ee),Te=B.getClearColor(),Pe=B.getClearAlpha(),Ve=Te.r,tt=Te.g,pt=Te.b;Ie?(y[0]=Ve,y[1]=tt,y[2]=pt,y[3]=Pe,z.clearBufferuiv(z.COLOR,0,y)):(w[0]=Ve,w[1]=tt,w[2]=pt,w[3]=Pe,z.clearBufferiv(z.COLOR,0,w))}else q|=z.COLOR_BUFFER_BIT}G&&(q|=z.DEPTH_BUFFER_BIT,this.state.buffers.depth.setMask(!0)),j&&(q|=z.STENCIL_BUFFER_BIT,this.state.buffers.stencil.setMask(4294967295)),q!==0&&z.clear(q)},this.clearColor=function(){this.clear(!0,!1,!1)},this.clearDepth=function(){this.clear(!1,!0,!1)},this.clearStencil=function(){this.clear(!1,!1,!0)},this.setNodesHandler=function(C){C.setRenderer(this),k=C},this.dispose=function(){t.removeEventListener("webglcontextlost",Be,!1),t.removeEventListener("webglcontextrestored",Qe,!1),t.removeEventListener("webglcontextcreationerror",Ce,!1),B.dispose(),be.dispose(),te.dispose(),$e.dispose(),Ge.dispose(),P.dispose(),he.dispose(),$.dispose(),Se.dispose(),We.dispose(),re.dispose(),ce.dispose(),ce.removeEventListener("sessionstart",cl),ce.removeEventListener("sessionend",ts),_s.stop()};function Be(C){C.preventDefault(),ud("WebGLRenderer: Context Lost."),L=!0}function Qe(){ud("WebGLRenderer: Context Restored."),L=!1;let C=Gt.autoReset,G=pe.enabled,j=pe.autoUpdate,q=pe.needsUpdate,Z=pe.type;je(),Gt.autoReset=C,pe.enabled=G,pe.autoUpdate=j,pe.needsUpdate=q,pe.type=Z}function Ce(C){et("WebGLRenderer: A WebGL context could not be created. Reason: ",C.statusMessage)}function lt(C){let G=C.target;G.removeEventListener("dispose",lt),qt(G)}function qt(C){ni(C),Ge.remove(C)}function ni(C){let G=Ge.get(C).programs;G!==void 0&&(G.forEach(function(j){re.releaseProgram(j)}),C.isShaderMaterial&&re.releaseShaderCache(C))}this.renderBufferDirect=function(C,G,j,q,Z,Ee){G===null&&(G=En);let Ie=Z.isMesh&&Z.matrixWorld.determinantAffine()<0,Te=ta(C,G,j,q,Z);we.setMaterial(q,Ie);let Pe=j.index,Ve=1;if(q.wireframe===!0){if(Pe=$.getWireframeAttribute(j),Pe===void 0)return;Ve=2}let tt=j.drawRange,pt=j.attributes.position,ze=tt.start*Ve,mt=(tt.start+tt.count)*Ve;Ee!==null&&(ze=Math.max(ze,Ee.start*Ve),mt=Math.min(mt,(Ee.start+Ee.count)*Ve)),Pe!==null?(ze=Math.max(ze,0),mt=Math.min(mt,Pe.count)):pt!=null&&(ze=Math.max(ze,0),mt=Math.min(mt,pt.count));let on=mt-ze;if(on<0||on===1/0)return;Se.setup(Z,q,Te,j,Pe);let Ut,Ft=ne;if(Pe!==null&&(Ut=A.get(Pe),Ft=Ae,Ft.setIndex(Ut)),Z.isMesh)q.wireframe===!0?(we.setLineWidth(q.wireframeLinewidth*yn()),Ft.setMode(z.LINES)):Ft.setMode(z.TRIANGLES);else if(Z.isLine){let Tn=q.linewidth;Tn===void 0&&(Tn=1),we.setLineWidth(Tn*yn()),Z.isLineSegments?Ft.setMode(z.LINES):Z.isLineLoop?Ft.setMode(z.LINE_LOOP):Ft.setMode(z.LINE_STRIP)}else Z.isPoints?Ft.setMode(z.POINTS):Z.isSprite&&Ft.setMode(z.TRIANGLES);if(Z.isBatchedMesh)if(Ze.get("WEBGL_multi_draw"))Ft.renderMultiDraw(Z._multiDrawStarts,Z._multiDrawCounts,Z._multiDrawCount);else{let Tn=Z._multiDrawStarts,Ue=Z._multiDrawCounts,_n=Z._multiDrawCount,xt=Pe?A.get(Pe).bytesPerElement:1,vs=Ge.get(q).currentProgram.getUniforms();for(let xn=0;xn<_n;xn++)vs.setValue(z,"_gl_DrawID",xn),Ft.render(Tn[xn]/xt,Ue[xn])}else if(Z.isInstancedMesh)Ft.renderInstances(ze,on,Z.count);else if(j.isInstancedBufferGeometry){let Tn=j._maxInstanceCount!==void 0?j._maxInstanceCount:1/0,Ue=Math.min(j.instanceCount,Tn);Ft.renderInstances(ze,on,Ue)}else Ft.render(ze,on)};function jo(C,G,j,q){k!==null&&C.isNodeMaterial&&k.setObject(q,C),$t===!0&&ie.setState(C,j,!1),C.transparent===!0&&C.side===di&&C.forceSinglePass===!1?(C.side=ui,C.needsUpdate=!0,ns(C,G,q),C.side=cr,C.needsUpdate=!0,ns(C,G,q),C.side=di):ns(C,G,q)}this.compile=function(C,G,j=null){j===null&&(j=C),k!==null&&k.renderStart(C,G,j),S=te.get(j),S.init(G),M.push(S),j.traverseVisible(function(Z){Z.isLight&&Z.layers.test(G.layers)&&(S.pushLight(Z),Z.castShadow&&S.pushShadow(Z))}),C!==j&&C.traverseVisible(function(Z){Z.isLight&&Z.layers.test(G.layers)&&(S.pushLight(Z),Z.castShadow&&S.pushShadow(Z))}),S.setupLights(),k!==null&&k.updateLights(S.state.lightsArray),gn=this.localClippingEnabled,$t=ie.init(this.clippingPlanes,gn),$t===!0&&ie.setGlobalState(this.clippingPlanes,G),k!==null&&pe.render(S.state.shadowsArray,j,G);let q=new Set;return C.traverse(function(Z){if(!(Z.isMesh||Z.isPoints||Z.isLine||Z.isSprite))return;let Ee=Z.material;if(Ee)if(Array.isArray(Ee))for(let Ie=0;Ie<Ee.length;Ie++){let Te=Ee[Ie];jo(Te,j,G,Z),q.add(Te)}else jo(Ee,j,G,Z),q.add(Ee)}),S=M.pop(),k!==null&&k.renderEnd(),q},this.compileAsync=function(C,G,j=null){let q=this.compile(C,G,j);return new Promise(Z=>{function Ee(){if(q.forEach(function(Ie){let Pe=Ge.get(Ie).currentProgram;(Pe===void 0||Pe.isReady())&&q.delete(Ie)}),q.size===0){Z(C);return}setTimeout(Ee,10)}Ze.get("KHR_parallel_shader_compile")!==null?Ee():setTimeout(Ee,10)})};let Gr=null;function nu(C){Gr&&Gr(C)}function cl(){_s.stop()}function ts(){_s.start()}let _s=new j0;_s.setAnimationLoop(nu),typeof self<"u"&&_s.setContext(self),this.setAnimationLoop=function(C){Gr=C,ce.setAnimationLoop(C),C===null?_s.stop():_s.start()},ce.addEventListener("sessionstart",cl),ce.addEventListener("sessionend",ts),this.render=function(C,G){if(G!==void 0&&G.isCamera!==!0){et("WebGLRenderer.render: camera is not an instance of THREE.Camera.");return}if(L===!0)return;k!==null&&k.renderStart(C,G);let j=ce.enabled===!0&&ce.isPresenting===!0,q=D!==null&&(ae===null||j)&&D.begin(I,ae);if(C.matrixWorldAutoUpdate===!0&&C.updateMatrixWorld(),G.parent===null&&G.matrixWorldAutoUpdate===!0&&G.updateMatrixWorld(),ce.enabled===!0&&ce.isPresenting===!0&&(D===null||D.isCompositing()===!1)&&(ce.cameraAutoUpdate===!0&&ce.updateCamera(G),G=ce.getCamera()),C.isScene===!0&&C.onBeforeRender(I,C,G,ae),S=te.get(C,M.length),S.init(G),S.state.textureUnits=$e.getTextureUnits(),M.push(S),Bt.multiplyMatrices(G.projectionMatrix,G.matrixWorldInverse),G.isArrayCamera?Qt.setFromArrayCamera(G):st.setFromProjectionMatrix(Bt,ki,G.reversedDepth),gn=this.localClippingEnabled,$t=ie.init(this.clippingPlanes,gn),E=be.get(C,_.length),E.init(),_.push(E),this.info.render.frame++,ce.enabled===!0&&ce.isPresenting===!0){let Ie=I.xr.getDepthSensingMesh();Ie!==null&&xs(Ie,G,-1/0,I.sortObjects)}xs(C,G,0,I.sortObjects),E.finish(),k!==null&&k.updateLights(S.state.lightsArray),I.sortObjects===!0&&E.sort(He,Ke),an=ce.enabled===!1||ce.isPresenting===!1||ce.hasDepthSensing()===!1,an&&B.addToRenderList(E,C),this.info.autoReset===!0&&this.info.reset(),$t===!0&&ie.beginShadows();let Z=S.state.shadowsArray;if(pe.render(Z,C,G),$t===!0&&ie.endShadows(),(q&&D.hasRenderPass())===!1){let Ie=E.opaque,Te=E.transmissive;if(S.setupLights(),G.isArrayCamera){let Pe=G.cameras;if(Te.length>0)for(let Ve=0,tt=Pe.length;Ve<tt;Ve++){let pt=Pe[Ve];Bi(Ie,Te,C,pt)}an&&B.render(C);for(let Ve=0,tt=Pe.length;Ve<tt;Ve++){let pt=Pe[Ve];Qo(E,C,pt,pt.viewport)}}else Te.length>0&&Bi(Ie,Te,C,G),an&&B.render(C),Qo(E,C,G)}ae!==null&&H===0&&($e.updateMultisampleRenderTarget(ae),$e.updateRenderTargetMipmap(ae)),q&&D.end(I),C.isScene===!0&&C.onAfterRender(I,C,G),Se.resetDefaultState(),Y=-1,J=null,M.pop(),M.length>0?(S=M[M.length-1],$e.setTextureUnits(S.state.textureUnits),$t===!0&&ie.setGlobalState(I.clippingPlanes,S.state.camera)):S=null,_.pop(),_.length>0?E=_[_.length-1]:E=null,k!==null&&k.renderEnd()};function xs(C,G,j,q){if(C.visible===!1)return;if(C.layers.test(G.layers)){if(C.isGroup)j=C.renderOrder;else if(C.isLOD)C.autoUpdate===!0&&C.update(G);else if(C.isLight)S.pushLight(C),C.castShadow&&S.pushShadow(C);else if(C.isSprite){let Ie=G.isArrayCamera?Qt:st;if(!C.frustumCulled||C.intersectsFrustum(Ie)){q&&St.setFromMatrixPosition(C.matrixWorld).applyMatrix4(Bt);let Te=he.update(C),Pe=C.material;Pe.visible&&E.push(C,Te,Pe,j,St.z,null,G)}}else if(C.isMesh||C.isLine||C.isPoints){let Ie=G.isArrayCamera?Qt:st;if(!C.frustumCulled||C.intersectsFrustum(Ie)){let Te=he.update(C),Pe=C.material;if(q&&(C.boundingSphere!==void 0?(C.boundingSphere===null&&C.computeBoundingSphere(),St.copy(C.boundingSphere.center)):(Te.boundingSphere===null&&Te.computeBoundingSphere(),St.copy(Te.boundingSphere.center)),St.applyMatrix4(C.matrixWorld).applyMatrix4(Bt)),Array.isArray(Pe)){let Ve=Te.groups;for(let tt=0,pt=Ve.length;tt<pt;tt++){let ze=Ve[tt],mt=Pe[ze.materialIndex];mt&&mt.visible&&E.push(C,Te,mt,j,St.z,ze,G)}}else Pe.visible&&E.push(C,Te,Pe,j,St.z,null,G)}}}let Ee=C.children;for(let Ie=0,Te=Ee.length;Ie<Te;Ie++)xs(Ee[Ie],G,j,q)}function Qo(C,G,j,q){let{opaque:Z,transmissive:Ee,transparent:Ie}=C;S.setupLightsView(j),$t===!0&&ie.setGlobalState(I.clippingPlanes,j),q&&we.viewport(ee.copy(q)),Z.length>0&&ln(Z,G,j),Ee.length>0&&ln(Ee,G,j),Ie.length>0&&ln(Ie,G,j),we.buffers.depth.setTest(!0),we.buffers.depth.setMask(!0),we.buffers.color.setMask(!0),we.setPolygonOffset(!1)}function Bi(C,G,j,q){if((j.isScene===!0?j.overrideMaterial:null)!==null)return;if(S.state.transmissionRenderTarget[q.id]===void 0){let ze=Ze.has("EXT_color_buffer_half_float")||Ze.has("EXT_color_buffer_float");S.state.transmissionRenderTarget[q.id]=new Ci(1,1,{generateMipmaps:!0,type:ze?ji:pi,minFilter:Fs,samples:Math.max(4,ot.samples),stencilBuffer:r,resolveDepthBuffer:!1,resolveStencilBuffer:!1,storeMultisampledDepthBuffer:!1,storeMultisampledStencilBuffer:!1,colorSpace:bt.workingColorSpace})}let Ee=S.state.transmissionRenderTarget[q.id],Ie=q.viewport||ee;Ee.setSize(Ie.z*I.transmissionResolutionScale,Ie.w*I.transmissionResolutionScale);let Te=I.getRenderTarget(),Pe=I.getActiveCubeFace(),Ve=I.getActiveMipmapLevel();I.setRenderTarget(Ee),I.getClearColor(Q),me=I.getClearAlpha(),me<1&&I.setClearColor(16777215,.5),I.clear(),an&&B.render(j);let tt=I.toneMapping;I.toneMapping=ms;let pt=q.viewport;if(q.viewport!==void 0&&(q.viewport=void 0),S.setupLightsView(q),$t===!0&&ie.setGlobalState(I.clippingPlanes,q),ln(C,j,q),$e.updateMultisampleRenderTarget(Ee),$e.updateRenderTargetMipmap(Ee),Ze.has("WEBGL_multisampled_render_to_texture")===!1){let ze=!1;for(let mt=0,on=G.length;mt<on;mt++){let Ut=G[mt],{object:Ft,geometry:Tn,material:Ue,group:_n}=Ut;if(Ue.side===di&&Ft.layers.test(q.layers)){let xt=Ue.side;Ue.side=ui,Ue.needsUpdate=!0,dn(Ft,j,q,Tn,Ue,_n),Ue.side=xt,Ue.needsUpdate=!0,ze=!0}}ze===!0&&($e.updateMultisampleRenderTarget(Ee),$e.updateRenderTargetMipmap(Ee))}I.setRenderTarget(Te,Pe,Ve),I.setClearColor(Q,me),pt!==void 0&&(q.viewport=pt),I.toneMapping=tt}function ln(C,G,j){let q=G.isScene===!0?G.overrideMaterial:null;for(let Z=0,Ee=C.length;Z<Ee;Z++){let Ie=C[Z],{object:Te,geometry:Pe,group:Ve}=Ie,tt=Ie.material;tt.allowOverride===!0&&q!==null&&(tt=q),Te.layers.test(j.layers)&&dn(Te,G,j,Pe,tt,Ve)}}function dn(C,G,j,q,Z,Ee){k!==null&&Z.isNodeMaterial&&k.setObject(C,Z),C.onBeforeRender(I,G,j,q,Z,Ee),C.modelViewMatrix.multiplyMatrices(j.matrixWorldInverse,C.matrixWorld),C.normalMatrix.getNormalMatrix(C.modelViewMatrix),Z.onBeforeRender(I,G,j,q,C,Ee),Z.transparent===!0&&Z.side===di&&Z.forceSinglePass===!1?(Z.side=ui,Z.needsUpdate=!0,I.renderBufferDirect(j,G,q,Z,C,Ee),Z.side=cr,Z.needsUpdate=!0,I.renderBufferDirect(j,G,q,Z,C,Ee),Z.side=di):I.renderBufferDirect(j,G,q,Z,C,Ee),C.onAfterRender(I,G,j,q,Z,Ee)}function pn(C){let G=0;for(let j of C)j.texture!==null&&G++;return G}function ns(C,G,j){G.isScene!==!0&&(G=En);let q=Ge.get(C),Z=S.state.lights,Ee=S.state.shadowsArray,Ie=Z.state.version,Te=re.getParameters(C,Z.state,Ee,G,j,S.state.lightProbeGridArray),Pe=re.getProgramCacheKey(Te),Ve=q.programs;q.environment=C.isMeshStandardMaterial||C.isMeshLambertMaterial||C.isMeshPhongMaterial?G.environment:null,q.fog=G.fog;let tt=C.isMeshStandardMaterial||C.isMeshLambertMaterial&&!C.envMap||C.isMeshPhongMaterial&&!C.envMap;q.envMap=P.get(C.envMap||q.environment,tt),q.envMapRotation=q.environment!==null&&C.envMap===null?G.environmentRotation:C.envMapRotation,Ve===void 0&&(C.addEventListener("dispose",lt),Ve=new Map,q.programs=Ve,q.programVariants=new Map);let pt=Ve.get(Pe);if(pt!==void 0){if(q.currentProgram===pt&&q.lightsStateVersion===Ie)return ea(C,Te),pt}else Te.uniforms=re.getUniforms(C),k!==null&&C.isNodeMaterial&&k.build(C,j,Te),C.onBeforeCompile(Te,I),pt=re.acquireProgram(Te,Pe),Ve.set(Pe,pt),q.uniforms=Te.uniforms;let ze=q.uniforms;return(!C.isShaderMaterial&&!C.isRawShaderMaterial||C.clipping===!0)&&(ze.clippingPlanes=ie.uniform),ea(C,Te),q.needsLights=zs(C),q.lightsStateVersion=Ie,q.needsLights&&(ze.ambientLightColor.value=Z.state.ambient,ze.lightProbe.value=Z.state.probe,ze.sunLights.value=Z.state.sun,ze.sunLightShadows.value=Z.state.sunShadow,ze.directionalLights.value=Z.state.directional,ze.directionalLightShadows.value=Z.state.directionalShadow,ze.spotLights.value=Z.state.spot,ze.spotLightShadows.value=Z.state.spotShadow,ze.rectAreaLights.value=Z.state.rectArea,ze.ltc_1.value=Z.state.rectAreaLTC1,ze.ltc_2.value=Z.state.rectAreaLTC2,ze.pointLights.value=Z.state.point,ze.pointLightShadows.value=Z.state.pointShadow,ze.hemisphereLights.value=Z.state.hemi,ze.sunShadowMatrix.value=Z.state.sunShadowMatrix,ze.sunShadowCascade.value=Z.state.sunShadowCascade,ze.directionalShadowMatrix.value=Z.state.directionalShadowMatrix,ze.spotLightMatrix.value=Z.state.spotLightMatrix,ze.spotLightMap.value=Z.state.spotLightMap,ze.pointShadowMatrix.value=Z.state.pointShadowMatrix),q.numLightProbeGrids=pn(S.state.lightProbeGridArray),q.currentProgram=pt,q.uniformsList=null,pt}function gi(C,G,j,q,Z){let Ee=Ge.get(C),Ie=Ee.currentProgram.id+","+q+","+Z,Te=Ee.programVariants.get(Ie);return Te===void 0?(Te=ns(C,G,j),Ee.programVariants.set(Ie,Te)):(Ee.currentProgram=Te,Ee.uniformsList=null,Ee.outputColorSpace=q,Ee.toneMapping=Z),Te}function Bs(C){if(C.uniformsList===null){let G=C.currentProgram.getUniforms();C.uniformsList=$o.seqWithValue(G.seq,C.uniforms)}return C.uniformsList}function ea(C,G){let j=Ge.get(C);j.outputColorSpace=G.outputColorSpace,j.batching=G.batching,j.batchingColor=G.batchingColor,j.instancing=G.instancing,j.instancingColor=G.instancingColor,j.instancingMorph=G.instancingMorph,j.skinning=G.skinning,j.morphTargets=G.morphTargets,j.morphNormals=G.morphNormals,j.morphColors=G.morphColors,j.morphTargetsCount=G.morphTargetsCount,j.numClippingPlanes=G.numClippingPlanes,j.numIntersection=G.numClipIntersection,j.vertexAlphas=G.vertexAlphas,j.vertexTangents=G.vertexTangents,j.toneMapping=G.toneMapping}function ta(C,G,j,q,Z){G.isScene!==!0&&(G=En),$e.resetTextureUnits();let Ee=G.fog,Ie=q.isMeshStandardMaterial||q.isMeshLambertMaterial||q.isMeshPhongMaterial?G.environment:null,Te=ae===null?I.outputColorSpace:ae.isXRRenderTarget===!0?ae.texture.colorSpace:bt.workingColorSpace,Pe=q.isMeshStandardMaterial||q.isMeshLambertMaterial&&!q.envMap||q.isMeshPhongMaterial&&!q.envMap,Ve=P.get(q.envMap||Ie,Pe),tt=q.vertexColors===!0&&!!j.attributes.color&&j.attributes.color.itemSize===4,pt=!!j.attributes.tangent&&(!!q.normalMap||q.anisotropy>0),ze=!!j.morphAttributes.position,mt=!!j.morphAttributes.normal,on=!!j.morphAttributes.color,Ut=ms;q.toneMapped&&(ae===null||ae.isXRRenderTarget===!0)&&(Ut=I.toneMapping);let Ft=j.morphAttributes.position||j.morphAttributes.normal||j.morphAttributes.color,Tn=Ft!==void 0?Ft.length:0,Ue=Ge.get(q),_n=S.state.lights;if($t===!0&&(gn===!0||C!==J)){let Ot=C===J&&q.id===Y;ie.setState(q,C,Ot)}let xt=!1,vs=!1;q.version===Ue.__version?Ue.needsLights&&Ue.lightsStateVersion!==_n.state.version||Z.isBatchedMesh&&Ue.batching===!1||!Z.isBatchedMesh&&Ue.batching===!0||Z.isBatchedMesh&&Ue.batchingColor===!0&&Z._colorsTexture===null||Z.isBatchedMesh&&Ue.batchingColor===!1&&Z._colorsTexture!==null||Z.isInstancedMesh&&Ue.instancing===!1||!Z.isInstancedMesh&&Ue.instancing===!0||Z.isSkinnedMesh&&Ue.skinning===!1||!Z.isSkinnedMesh&&Ue.skinning===!0||Z.isInstancedMesh&&Ue.instancingColor===!0&&Z.instanceColor===null||Z.isInstancedMesh&&Ue.instancingColor===!1&&Z.instanceColor!==null||Z.isInstancedMesh&&Ue.instancingMorph===!0&&Z.morphTexture===null||Z.isInstancedMesh&&Ue.instancingMorph===!1&&Z.morphTexture!==null||Ue.envMap!==Ve||q.fog===!0&&Ue.fog!==Ee||Ue.numClippingPlanes!==void 0&&(Ue.numClippingPlanes!==ie.numPlanes||Ue.numIntersection!==ie.numIntersection)||Ue.vertexAlphas!==tt||Ue.vertexTangents!==pt||Ue.morphTargets!==ze||Ue.morphNormals!==mt||Ue.morphColors!==on||Ue.morphTargetsCount!==Tn||Ue.numLightProbeGrids!==pn(S.state.lightProbeGridArray)?xt=!0:(Ue.outputColorSpace!==Te||Ue.toneMapping!==Ut)&&(vs=!0):(xt=!0,Ue.__version=q.version);let xn=Ue.currentProgram;(xt===!0||vs===!0)&&(xn=vs===!0?gi(q,G,Z,Te,Ut):ns(q,G,Z),k&&q.isNodeMaterial&&k.onUpdateProgram(q,xn,Ue));let $r=!1,is=!1,bs=!1,ht=xn.getUniforms(),cn=Ue.uniforms;if(we.useProgram(xn.program)&&($r=!0,is=!0,bs=!0),q.id!==Y&&(Y=q.id,is=!0),$r||J!==C){we.buffers.depth.getReversed()&&C.reversedDepth!==!0&&(C._reversedDepth=!0,C.updateProjectionMatrix()),ht.setValue(z,"projectionMatrix",C.projectionMatrix),ht.setValue(z,"viewMatrix",C.matrixWorldInverse);let vn=ht.map.cameraPosition;vn!==void 0&&vn.setValue(z,Dn.setFromMatrixPosition(C.matrixWorld)),ot.logarithmicDepthBuffer&&ht.setValue(z,"logDepthBufFC",2/(Math.log(C.far+1)/Math.LN2)),(q.isMeshPhongMaterial||q.isMeshToonMaterial||q.isMeshLambertMaterial||q.isMeshBasicMaterial||q.isMeshStandardMaterial||q.isShaderMaterial)&&ht.setValue(z,"isOrthographic",C.isOrthographicCamera===!0),J!==C&&(J=C,is=!0,bs=!0)}if(Ue.needsLights&&(_n.state.sunShadowMap.length>0&&ht.setValue(z,"sunShadowMap",_n.state.sunShadowMap,$e),_n.state.directionalShadowMap.length>0&&ht.setValue(z,"directionalShadowMap",_n.state.directionalShadowMap,$e),_n.state.spotShadowMap.length>0&&ht.setValue(z,"spotShadowMap",_n.state.spotShadowMap,$e),_n.state.pointShadowMap.length>0&&ht.setValue(z,"pointShadowMap",_n.state.pointShadowMap,$e)),Z.isSkinnedMesh){ht.setOptional(z,Z,"bindMatrix"),ht.setOptional(z,Z,"bindMatrixInverse");let Ot=Z.skeleton;Ot&&(Ot.boneTexture===null&&Ot.computeBoneTexture(),ht.setValue(z,"boneTexture",Ot.boneTexture,$e))}Z.isBatchedMesh&&(ht.setOptional(z,Z,"batchingTexture"),ht.setValue(z,"batchingTexture",Z._matricesTexture,$e),ht.setOptional(z,Z,"batchingIdTexture"),ht.setValue(z,"batchingIdTexture",Z._indirectTexture,$e),ht.setOptional(z,Z,"batchingColorTexture"),Z._colorsTexture!==null&&ht.setValue(z,"batchingColorTexture",Z._colorsTexture,$e));let ii=j.morphAttributes;if((ii.position!==void 0||ii.normal!==void 0||ii.color!==void 0)&&se.update(Z,j,xn),(is||Ue.receiveShadow!==Z.receiveShadow)&&(Ue.receiveShadow=Z.receiveShadow,ht.setValue(z,"receiveShadow",Z.receiveShadow)),(q.isMeshStandardMaterial||q.isMeshLambertMaterial||q.isMeshPhongMaterial)&&q.envMap===null&&G.environment!==null&&(cn.envMapIntensity.value=G.environmentIntensity),cn.dfgLUT!==void 0&&(cn.dfgLUT.value=ZA()),is){if(ht.setValue(z,"toneMappingExposure",I.toneMappingExposure),Ue.needsLights&&Wr(cn,bs),Ee&&q.fog===!0&&ve.refreshFogUniforms(cn,Ee),ve.refreshMaterialUniforms(cn,q,ye,_e,S.state.transmissionRenderTarget[C.id]),Ue.needsLights&&Ue.numLightProbeGrids>0){let Ot=v,vn=0;for(let qn of S.state.lightProbeGridArray)qn.texture!==null&&(Ot.textures[vn]=qn.texture,Ot.min[vn]=qn.boundingBox.min,Ot.max[vn]=qn.boundingBox.max,Ot.resolution[vn]=qn.resolution,vn++);for(let qn in Ot)Ot[qn].length=vn;cn.probesSH.value=Ot.textures,cn.probesMin.value=Ot.min,cn.probesMax.value=Ot.max,cn.probesResolution.value=Ot.resolution}$o.upload(z,Bs(Ue),cn,$e)}if(q.isShaderMaterial&&q.uniformsNeedUpdate===!0&&($o.upload(z,Bs(Ue),cn,$e),q.uniformsNeedUpdate=!1),q.isSpriteMaterial&&ht.setValue(z,"center",Z.center),ht.setValue(z,"modelViewMatrix",Z.modelViewMatrix),ht.setValue(z,"normalMatrix",Z.normalMatrix),ht.setValue(z,"modelMatrix",Z.matrixWorld),q.uniformsGroups!==void 0){let Ot=q.uniformsGroups;for(let vn=0,qn=Ot.length;vn<qn;vn++){let hl=Ot[vn];We.update(hl,xn),We.bind(hl,xn)}}return xn}function Wr(C,G){C.ambientLightColor.needsUpdate=G,C.lightProbe.needsUpdate=G,C.sunLights.needsUpdate=G,C.sunLightShadows.needsUpdate=G,C.directionalLights.needsUpdate=G,C.directionalLightShadows.needsUpdate=G,C.pointLights.needsUpdate=G,C.pointLightShadows.needsUpdate=G,C.spotLights.needsUpdate=G,C.spotLightShadows.needsUpdate=G,C.rectAreaLights.needsUpdate=G,C.hemisphereLights.needsUpdate=G}function zs(C){return C.isMeshLambertMaterial||C.isMeshToonMaterial||C.isMeshPhongMaterial||C.isMeshStandardMaterial||C.isShadowMaterial||C.isShaderMaterial&&C.lights===!0}this.getActiveCubeFace=function(){return X},this.getActiveMipmapLevel=function(){return H},this.getRenderTarget=function(){return ae},this.setRenderTargetTextures=function(C,G,j){let q=Ge.get(C);q.__autoAllocateDepthBuffer=C.resolveDepthBuffer===!1,q.__autoAllocateDepthBuffer===!1&&(q.__useRenderToTexture=!1),Ge.get(C.texture).__webglTexture=G,Ge.get(C.depthTexture).__webglTexture=q.__autoAllocateDepthBuffer?void 0:j,q.__hasExternalTextures=!0},this.setRenderTargetFramebuffer=function(C,G){let j=Ge.get(C);j.__webglFramebuffer=G,j.__useDefaultFramebuffer=G===void 0},this.setRenderTarget=function(C,G=0,j=0){ae=C,X=G,H=j;let q=null,Z=!1,Ee=!1;if(C){let Te=Ge.get(C);if(Te.__useDefaultFramebuffer!==void 0){we.bindFramebuffer(z.FRAMEBUFFER,Te.__webglFramebuffer),ee.copy(C.viewport),fe.copy(C.scissor),ue=C.scissorTest,we.viewport(ee),we.scissor(fe),we.setScissorTest(ue),Y=-1;return}else if(Te.__webglFramebuffer===void 0)$e.setupRenderTarget(C);else if(Te.__hasExternalTextures)$e.rebindTextures(C,Ge.get(C.texture).__webglTexture,Ge.get(C.depthTexture).__webglTexture);else if(C.depthBuffer){let tt=C.depthTexture;if(Te.__boundDepthTexture!==tt){if(tt!==null&&Ge.has(tt)&&(C.width!==tt.image.width||C.height!==tt.image.height))throw new Error("THREE.WebGLRenderer: Attached DepthTexture is initialized to the incorrect size.");$e.setupDepthRenderbuffer(C)}}let Pe=C.texture;(Pe.isData3DTexture||Pe.isDataArrayTexture||Pe.isCompressedArrayTexture)&&(Ee=!0);let Ve=Ge.get(C).__webglFramebuffer;C.isWebGLCubeRenderTarget?(Array.isArray(Ve[G])?q=Ve[G][j]:q=Ve[G],Z=!0):C.samples>0&&$e.useMultisampledRTT(C)===!1?q=Ge.get(C).__webglMultisampledFramebuffer:Array.isArray(Ve)?q=Ve[j]:q=Ve,ee.copy(C.viewport),fe.copy(C.scissor),ue=C.scissorTest}else ee.copy(Oe).multiplyScalar(ye).floor(),fe.copy(it).multiplyScalar(ye).floor(),ue=at;if(j!==0&&(q=V),we.bindFramebuffer(z.FRAMEBUFFER,q)&&we.drawBuffers(C,q),we.viewport(ee),we.scissor(fe),we.setScissorTest(ue),Z){let Te=Ge.get(C.texture);z.framebufferTexture2D(z.FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_CUBE_MAP_POSITIVE_X+G,Te.__webglTexture,j)}else if(Ee){let Te=G;for(let Pe=0;Pe<C.textures.length;Pe++){let Ve=Ge.get(C.textures[Pe]);z.framebufferTextureLayer(z.FRAMEBUFFER,z.COLOR_ATTACHMENT0+Pe,Ve.__webglTexture,j,Te)}}else if(C!==null&&j!==0){let Te=Ge.get(C.texture);z.framebufferTexture2D(z.FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_2D,Te.__webglTexture,j)}Y=-1};function Xr(C){let G=Ge.get(C);return(G.__readFormat!==C.format||G.__readType!==C.type)&&(G.__readFormat=C.format,G.__readType=C.type,G.__formatReadable=ot.textureFormatReadable(C.format),G.__typeReadable=ot.textureTypeReadable(C.type)),G}this.readRenderTargetPixels=function(C,G,j,q,Z,Ee,Ie,Te=0){if(!(C&&C.isWebGLRenderTarget)){et("WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");return}let Pe=Ge.get(C).__webglFramebuffer;if(C.isWebGLCubeRenderTarget&&Ie!==void 0&&(Pe=Pe[Ie],Array.isArray(Pe)&&(Pe=Pe[0])),Pe){we.bindFramebuffer(z.FRAMEBUFFER,Pe);try{let Ve=C.textures[Te],tt=Ve.format,pt=Ve.type;C.textures.length>1&&z.readBuffer(z.COLOR_ATTACHMENT0+Te);let ze=Xr(Ve);if(ze.__formatReadable===!1){et("WebGLRenderer.readRenderTargetPixels: renderTarget is not in RGBA or implementation defined format.");return}if(ze.__typeReadable===!1){et("WebGLRenderer.readRenderTargetPixels: renderTarget is not in UnsignedByteType or implementation defined type.");return}G>=0&&G<=C.width-q&&j>=0&&j<=C.height-Z&&z.readPixels(G,j,q,Z,xe.convert(tt),xe.convert(pt),Ee)}finally{let Ve=ae!==null?Ge.get(ae).__webglFramebuffer:null;we.bindFramebuffer(z.FRAMEBUFFER,Ve)}}},this.readRenderTargetPixelsAsync=async function(C,G,j,q,Z,Ee,Ie,Te=0){if(!(C&&C.isWebGLRenderTarget))throw new Error("THREE.WebGLRenderer.readRenderTargetPixels: renderTarget is not THREE.WebGLRenderTarget.");let Pe=Ge.get(C).__webglFramebuffer;if(C.isWebGLCubeRenderTarget&&Ie!==void 0&&(Pe=Pe[Ie],Array.isArray(Pe)&&(Pe=Pe[0])),Pe)if(G>=0&&G<=C.width-q&&j>=0&&j<=C.height-Z){we.bindFramebuffer(z.FRAMEBUFFER,Pe);let Ve=C.textures[Te],tt=Ve.format,pt=Ve.type;C.textures.length>1&&z.readBuffer(z.COLOR_ATTACHMENT0+Te);let ze=Xr(Ve);if(ze.__formatReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in RGBA or implementation defined format.");if(ze.__typeReadable===!1)throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: renderTarget is not in UnsignedByteType or implementation defined type.");let mt=z.createBuffer();z.bindBuffer(z.PIXEL_PACK_BUFFER,mt),z.bufferData(z.PIXEL_PACK_BUFFER,Ee.byteLength,z.STREAM_READ),z.readPixels(G,j,q,Z,xe.convert(tt),xe.convert(pt),0),z.bindBuffer(z.PIXEL_PACK_BUFFER,null);let on=ae!==null?Ge.get(ae).__webglFramebuffer:null;we.bindFramebuffer(z.FRAMEBUFFER,on);let Ut=z.fenceSync(z.SYNC_GPU_COMMANDS_COMPLETE,0);return z.flush(),await S0(z,Ut,4),z.bindBuffer(z.PIXEL_PACK_BUFFER,mt),z.getBufferSubData(z.PIXEL_PACK_BUFFER,0,Ee),z.bindBuffer(z.PIXEL_PACK_BUFFER,null),z.deleteBuffer(mt),z.deleteSync(Ut),Ee}else throw new Error("THREE.WebGLRenderer.readRenderTargetPixelsAsync: requested read bounds are out of range.")},this.copyFramebufferToTexture=function(C,G=null,j=0){let q=Math.pow(2,-j),Z=Math.floor(C.image.width*q),Ee=Math.floor(C.image.height*q),Ie=G!==null?G.x:0,Te=G!==null?G.y:0;$e.setTexture2D(C,0),z.copyTexSubImage2D(z.TEXTURE_2D,j,0,0,Ie,Te,Z,Ee),we.unbindTexture()},this.copyTextureToTexture=function(C,G,j=null,q=null,Z=0,Ee=0){let Ie,Te,Pe,Ve,tt,pt,ze,mt,on,Ut=C.isCompressedTexture?C.mipmaps[Ee]:C.image;if(j!==null)Ie=j.max.x-j.min.x,Te=j.max.y-j.min.y,Pe=j.isBox3?j.max.z-j.min.z:1,Ve=j.min.x,tt=j.min.y,pt=j.isBox3?j.min.z:0;else{let ht=Math.pow(2,-Z);Ie=Math.floor(Ut.width*ht),Te=Math.floor(Ut.height*ht),C.isDataArrayTexture?Pe=Ut.depth:C.isData3DTexture?Pe=Math.floor(Ut.depth*ht):Pe=1,Ve=0,tt=0,pt=0}q!==null?(ze=q.x,mt=q.y,on=q.z):(ze=0,mt=0,on=0);let Ft=xe.convert(G.format),Tn=xe.convert(G.type),Ue;G.isData3DTexture?($e.setTexture3D(G,0),Ue=z.TEXTURE_3D):G.isDataArrayTexture||G.isCompressedArrayTexture?($e.setTexture2DArray(G,0),Ue=z.TEXTURE_2D_ARRAY):($e.setTexture2D(G,0),Ue=z.TEXTURE_2D),we.activeTexture(z.TEXTURE0),we.pixelStorei(z.UNPACK_FLIP_Y_WEBGL,G.flipY),we.pixelStorei(z.UNPACK_PREMULTIPLY_ALPHA_WEBGL,G.premultiplyAlpha),we.pixelStorei(z.UNPACK_ALIGNMENT,G.unpackAlignment);let _n=we.getParameter(z.UNPACK_ROW_LENGTH),xt=we.getParameter(z.UNPACK_IMAGE_HEIGHT),vs=we.getParameter(z.UNPACK_SKIP_PIXELS),xn=we.getParameter(z.UNPACK_SKIP_ROWS),$r=we.getParameter(z.UNPACK_SKIP_IMAGES);we.pixelStorei(z.UNPACK_ROW_LENGTH,Ut.width),we.pixelStorei(z.UNPACK_IMAGE_HEIGHT,Ut.height),we.pixelStorei(z.UNPACK_SKIP_PIXELS,Ve),we.pixelStorei(z.UNPACK_SKIP_ROWS,tt),we.pixelStorei(z.UNPACK_SKIP_IMAGES,pt);let is=C.isDataArrayTexture||C.isData3DTexture,bs=G.isDataArrayTexture||G.isData3DTexture;if(C.isDepthTexture){let ht=Ge.get(C),cn=Ge.get(G),ii=Ge.get(ht.__renderTarget),Ot=Ge.get(cn.__renderTarget);we.bindFramebuffer(z.READ_FRAMEBUFFER,ii.__webglFramebuffer),we.bindFramebuffer(z.DRAW_FRAMEBUFFER,Ot.__webglFramebuffer);for(let vn=0;vn<Pe;vn++)is&&(z.framebufferTextureLayer(z.READ_FRAMEBUFFER,z.COLOR_ATTACHMENT0,Ge.get(C).__webglTexture,Z,pt+vn),z.framebufferTextureLayer(z.DRAW_FRAMEBUFFER,z.COLOR_ATTACHMENT0,Ge.get(G).__webglTexture,Ee,on+vn)),z.blitFramebuffer(Ve,tt,Ve+Ie,tt+Te,ze,mt,ze+Ie,mt+Te,z.DEPTH_BUFFER_BIT,z.NEAREST);we.bindFramebuffer(z.READ_FRAMEBUFFER,null),we.bindFramebuffer(z.DRAW_FRAMEBUFFER,null)}else if(Z!==0||C.isRenderTargetTexture||Ge.has(C)){let ht=Ge.get(C),cn=Ge.get(G);we.bindFramebuffer(z.READ_FRAMEBUFFER,R),we.bindFramebuffer(z.DRAW_FRAMEBUFFER,U);for(let ii=0;ii<Pe;ii++)is?z.framebufferTextureLayer(z.READ_FRAMEBUFFER,z.COLOR_ATTACHMENT0,ht.__webglTexture,Z,pt+ii):z.framebufferTexture2D(z.READ_FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_2D,ht.__webglTexture,Z),bs?z.framebufferTextureLayer(z.DRAW_FRAMEBUFFER,z.COLOR_ATTACHMENT0,cn.__webglTexture,Ee,on+ii):z.framebufferTexture2D(z.DRAW_FRAMEBUFFER,z.COLOR_ATTACHMENT0,z.TEXTURE_2D,cn.__webglTexture,Ee),Z!==0?z.blitFramebuffer(Ve,tt,Ve+Ie,tt+Te,ze,mt,ze+Ie,mt+Te,z.COLOR_BUFFER_BIT,z.NEAREST):bs?z.copyTexSubImage3D(Ue,Ee,ze,mt,on+ii,Ve,tt,Ie,Te):z.copyTexSubImage2D(Ue,Ee,ze,mt,Ve,tt,Ie,Te);we.bindFramebuffer(z.READ_FRAMEBUFFER,null),we.bindFramebuffer(z.DRAW_FRAMEBUFFER,null)}else bs?C.isDataTexture||C.isData3DTexture?z.texSubImage3D(Ue,Ee,ze,mt,on,Ie,Te,Pe,Ft,Tn,Ut.data):G.isCompressedArrayTexture?z.compressedTexSubImage3D(Ue,Ee,ze,mt,on,Ie,Te,Pe,Ft,Ut.data):z.texSubImage3D(Ue,Ee,ze,mt,on,Ie,Te,Pe,Ft,Tn,Ut):C.isDataTexture?z.texSubImage2D(z.TEXTURE_2D,Ee,ze,mt,Ie,Te,Ft,Tn,Ut.data):C.isCompressedTexture?z.compressedTexSubImage2D(z.TEXTURE_2D,Ee,ze,mt,Ut.width,Ut.height,Ft,Ut.data):z.texSubImage2D(z.TEXTURE_2D,Ee,ze,mt,Ie,Te,Ft,Tn,Ut);we.pixelStorei(z.UNPACK_ROW_LENGTH,_n),we.pixelStorei(z.UNPACK_IMAGE_HEIGHT,xt),we.pixelStorei(z.UNPACK_SKIP_PIXELS,vs),we.pixelStorei(z.UNPACK_SKIP_ROWS,xn),we.pixelStorei(z.UNPACK_SKIP_IMAGES,$r),Ee===0&&G.generateMipmaps===!0&&G.mipmapsAutoUpdate===!0&&z.generateMipmap(Ue),we.unbindTexture()},this.initRenderTarget=function(C){Ge.get(C).__webglFramebuffer===void 0&&$e.setupRenderTarget(C)},this.initTexture=function(C){C.isCubeTexture?$e.setTextureCube(C,0):C.isData3DTexture?$e.setTexture3D(C,0):C.isDataArrayTexture||C.isCompressedArrayTexture?$e.setTexture2DArray(C,0):$e.setTexture2D(C,0),we.unbindTexture()},this.resetState=function(){X=0,H=0,ae=null,we.reset(),Se.reset()},typeof __THREE_DEVTOOLS__<"u"&&__THREE_DEVTOOLS__.dispatchEvent(new CustomEvent("observe",{detail:this}))}get coordinateSystem(){return ki}get outputColorSpace(){return this._outputColorSpace}set outputColorSpace(e){this._outputColorSpace=e;let t=this.getContext();t.drawingBufferColorSpace=bt._getDrawingBufferColorSpace(e),t.unpackColorSpace=bt._getUnpackColorSpace()}};var cy={type:"change"},Pd={type:"start"},uy={type:"end"},Wh=new Qs,hy=new jn,KA=Math.cos(70*md.DEG2RAD),Ln=new O,mi=2*Math.PI,It={NONE:-1,ROTATE:0,DOLLY:1,PAN:2,TOUCH_ROTATE:3,TOUCH_PAN:4,TOUCH_DOLLY_PAN:5,TOUCH_DOLLY_ROTATE:6},Id=1e-6,Xh=class extends Za{constructor(e,t=null){super(e,t),this.state=It.NONE,this.target=new O,this.cursor=new O,this.minDistance=0,this.maxDistance=1/0,this.minZoom=0,this.maxZoom=1/0,this.minTargetRadius=0,this.maxTargetRadius=1/0,this.minPolarAngle=0,this.maxPolarAngle=Math.PI,this.minAzimuthAngle=-1/0,this.maxAzimuthAngle=1/0,this.enableDamping=!1,this.dampingFactor=.05,this.enableZoom=!0,this.zoomSpeed=1,this.enableRotate=!0,this.rotateSpeed=1,this.keyRotateSpeed=1,this.enablePan=!0,this.panSpeed=1,this.screenSpacePanning=!0,this.keyPanSpeed=7,this.zoomToCursor=!1,this.autoRotate=!1,this.autoRotateSpeed=2,this.keys={LEFT:"ArrowLeft",UP:"ArrowUp",RIGHT:"ArrowRight",BOTTOM:"ArrowDown"},this.mouseButtons={LEFT:ar.ROTATE,MIDDLE:ar.DOLLY,RIGHT:ar.PAN},this.touches={ONE:lr.ROTATE,TWO:lr.DOLLY_PAN},this.target0=this.target.clone(),this.position0=this.object.position.clone(),this.zoom0=this.object.zoom,this._cursorStyle="auto",this._domElementKeyEvents=null,this._lastPosition=new O,this._lastQuaternion=new tn,this._lastTargetPosition=new O,this._quat=new tn().setFromUnitVectors(e.up,new O(0,1,0)),this._quatInverse=this._quat.clone().invert(),this._spherical=new Bo,this._sphericalDelta=new Bo,this._scale=1,this._panOffset=new O,this._rotateStart=new qe,this._rotateEnd=new qe,this._rotateDelta=new qe,this._panStart=new qe,this._panEnd=new qe,this._panDelta=new qe,this._dollyStart=new qe,this._dollyEnd=new qe,this._dollyDelta=new qe,this._dollyDirection=new O,this._mouse=new qe,this._performCursorZoom=!1,this._pointers=[],this._pointerPositions={},this._controlActive=!1,this._onPointerMove=jA.bind(this),this._onPointerDown=JA.bind(this),this._onPointerUp=QA.bind(this),this._onContextMenu=oE.bind(this),this._onMouseWheel=nE.bind(this),this._onKeyDown=iE.bind(this),this._onTouchStart=sE.bind(this),this._onTouchMove=rE.bind(this),this._onMouseDown=eE.bind(this),this._onMouseMove=tE.bind(this),this._interceptControlDown=aE.bind(this),this._interceptControlUp=lE.bind(this),this.domElement!==null&&this.connect(this.domElement),this.update()}set cursorStyle(e){this._cursorStyle=e,e==="grab"?this.domElement.style.cursor="grab":this.domElement.style.cursor="auto"}get cursorStyle(){return this._cursorStyle}connect(e){super.connect(e),this.domElement.addEventListener("pointerdown",this._onPointerDown),this.domElement.addEventListener("pointercancel",this._onPointerUp),this.domElement.addEventListener("contextmenu",this._onContextMenu),this.domElement.addEventListener("wheel",this._onMouseWheel,{passive:!1}),this.domElement.ownerDocument.addEventListener("keydown",this._interceptControlDown,{passive:!0,capture:!0}),this.domElement.style.touchAction="none"}disconnect(){this.state=It.NONE,this.domElement.removeEventListener("pointerdown",this._onPointerDown),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.domElement.removeEventListener("pointercancel",this._onPointerUp),this.domElement.removeEventListener("wheel",this._onMouseWheel),this.domElement.removeEventListener("contextmenu",this._onContextMenu),this.stopListenToKeyEvents(),this.domElement.ownerDocument.removeEventListener("keydown",this._interceptControlDown,{capture:!0}),this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{capture:!0}),this._controlActive=!1,this._pointers.length=0,this._pointerPositions={},this.domElement.style.touchAction="",this.domElement.style.cursor="auto"}dispose(){this.disconnect()}getPolarAngle(){return this._spherical.phi}getAzimuthalAngle(){return this._spherical.theta}getDistance(){return this.object.position.distanceTo(this.target)}listenToKeyEvents(e){e.addEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=e}stopListenToKeyEvents(){this._domElementKeyEvents!==null&&(this._domElementKeyEvents.removeEventListener("keydown",this._onKeyDown),this._domElementKeyEvents=null)}saveState(){this.target0.copy(this.target),this.position0.copy(this.object.position),this.zoom0=this.object.zoom}reset(){this.target.copy(this.target0),this.object.position.copy(this.position0),this.object.zoom=this.zoom0,this.object.updateProjectionMatrix(),this.dispatchEvent(cy),this.update(),this.state=It.NONE}pan(e,t){this._pan(e,t),this.update()}dollyIn(e){this._dollyIn(e),this.update()}dollyOut(e){this._dollyOut(e),this.update()}rotateLeft(e){this._rotateLeft(e),this.update()}rotateUp(e){this._rotateUp(e),this.update()}update(e=null){let t=this.object.position;Ln.copy(t).sub(this.target),Ln.applyQuaternion(this._quat),this._spherical.setFromVector3(Ln),this.autoRotate&&this.state===It.NONE&&this._rotateLeft(this._getAutoRotationAngle(e)),this.enableDamping?(this._spherical.theta+=this._sphericalDelta.theta*this.dampingFactor,this._spherical.phi+=this._sphericalDelta.phi*this.dampingFactor):(this._spherical.theta+=this._sphericalDelta.theta,this._spherical.phi+=this._sphericalDelta.phi);let n=this.minAzimuthAngle,s=this.maxAzimuthAngle;isFinite(n)&&isFinite(s)&&(n<-Math.PI?n+=mi:n>Math.PI&&(n-=mi),s<-Math.PI?s+=mi:s>Math.PI&&(s-=mi),n<=s?this._spherical.theta=Math.max(n,Math.min(s,this._spherical.theta)):this._spherical.theta=this._spherical.theta>(n+s)/2?Math.max(n,this._spherical.theta):Math.min(s,this._spherical.theta)),this._spherical.phi=Math.max(this.minPolarAngle,Math.min(this.maxPolarAngle,this._spherical.phi)),this._spherical.makeSafe(),this.enableDamping===!0?this.target.addScaledVector(this._panOffset,this.dampingFactor):this.target.add(this._panOffset),this.target.sub(this.cursor),this.target.clampLength(this.minTargetRadius,this.maxTargetRadius),this.target.add(this.cursor);let r=!1;if(this.zoomToCursor&&this._performCursorZoom||this.object.isOrthographicCamera)this._spherical.radius=this._clampDistance(this._spherical.radius);else{let o=this._spherical.radius;this._spherical.radius=this._clampDistance(this._spherical.radius*this._scale),r=o!=this._spherical.radius}if(Ln.setFromSpherical(this._spherical),Ln.applyQuaternion(this._quatInverse),t.copy(this.target).add(Ln),this.object.lookAt(this.target),this.enableDamping===!0?(this._sphericalDelta.theta*=1-this.dampingFactor,this._sphericalDelta.phi*=1-this.dampingFactor,this._panOffset.multiplyScalar(1-this.dampingFactor)):(this._sphericalDelta.set(0,0,0),this._panOffset.set(0,0,0)),this.zoomToCursor&&this._performCursorZoom){let o=null;if(this.object.isPerspectiveCamera){let a=Ln.length();o=this._clampDistance(a*this._scale);let l=a-o;this.object.position.addScaledVector(this._dollyDirection,l),this.object.updateMatrixWorld(),r=!!l}else if(this.object.isOrthographicCamera){let a=new O(this._mouse.x,this._mouse.y,0);a.unproject(this.object);let l=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),this.object.updateProjectionMatrix(),r=l!==this.object.zoom;let c=new O(this._mouse.x,this._mouse.y,0);c.unproject(this.object),this.object.position.sub(c).add(a),this.object.updateMatrixWorld(),o=Ln.length()}else console.warn("WARNING: OrbitControls.js encountered an unknown camera type - zoom to cursor disabled."),this.zoomToCursor=!1;o!==null&&(this.screenSpacePanning?this.target.set(0,0,-1).transformDirection(this.object.matrix).multiplyScalar(o).add(this.object.position):(Wh.origin.copy(this.object.position),Wh.direction.set(0,0,-1).transformDirection(this.object.matrix),Math.abs(this.object.up.dot(Wh.direction))<KA?this.object.lookAt(this.target):(hy.setFromNormalAndCoplanarPoint(this.object.up,this.target),Wh.intersectPlane(hy,this.target))))}else if(this.object.isOrthographicCamera){let o=this.object.zoom;this.object.zoom=Math.max(this.minZoom,Math.min(this.maxZoom,this.object.zoom/this._scale)),o!==this.object.zoom&&(this.object.updateProjectionMatrix(),r=!0)}return this._scale=1,this._performCursorZoom=!1,r||this._lastPosition.distanceToSquared(this.object.position)>Id||8*(1-this._lastQuaternion.dot(this.object.quaternion))>Id||this._lastTargetPosition.distanceToSquared(this.target)>Id?(this.dispatchEvent(cy),this._lastPosition.copy(this.object.position),this._lastQuaternion.copy(this.object.quaternion),this._lastTargetPosition.copy(this.target),!0):!1}_getAutoRotationAngle(e){return e!==null?mi/60*this.autoRotateSpeed*e:mi/60/60*this.autoRotateSpeed}_getZoomScale(e){let t=Math.abs(e*.01);return Math.pow(.95,this.zoomSpeed*t)}_rotateLeft(e){this._sphericalDelta.theta-=e}_rotateUp(e){this._sphericalDelta.phi-=e}_panLeft(e,t){Ln.setFromMatrixColumn(t,0),Ln.multiplyScalar(-e),this._panOffset.add(Ln)}_panUp(e,t){this.screenSpacePanning===!0?Ln.setFromMatrixColumn(t,1):(Ln.setFromMatrixColumn(t,0),Ln.crossVectors(this.object.up,Ln)),Ln.multiplyScalar(e),this._panOffset.add(Ln)}_pan(e,t){let n=this.domElement;if(this.object.isPerspectiveCamera){let s=this.object.position;Ln.copy(s).sub(this.target);let r=Ln.length();r*=Math.tan(this.object.fov/2*Math.PI/180),this._panLeft(2*e*r/n.clientHeight,this.object.matrix),this._panUp(2*t*r/n.clientHeight,this.object.matrix)}else this.object.isOrthographicCamera?(this._panLeft(e*(this.object.right-this.object.left)/this.object.zoom/n.clientWidth,this.object.matrix),this._panUp(t*(this.object.top-this.object.bottom)/this.object.zoom/n.clientHeight,this.object.matrix)):(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - pan disabled."),this.enablePan=!1)}_dollyOut(e){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale/=e:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_dollyIn(e){this.object.isPerspectiveCamera||this.object.isOrthographicCamera?this._scale*=e:(console.warn("WARNING: OrbitControls.js encountered an unknown camera type - dolly/zoom disabled."),this.enableZoom=!1)}_updateZoomParameters(e,t){if(!this.zoomToCursor)return;this._performCursorZoom=!0;let n=this.domElement.getBoundingClientRect(),s=e-n.left,r=t-n.top,o=n.width,a=n.height;this._mouse.x=s/o*2-1,this._mouse.y=-(r/a)*2+1,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()}_clampDistance(e){return Math.max(this.minDistance,Math.min(this.maxDistance,e))}_handleMouseDownRotate(e){this._rotateStart.set(e.clientX,e.clientY)}_handleMouseDownDolly(e){this._updateZoomParameters(e.clientX,e.clientY),this._dollyStart.set(e.clientX,e.clientY)}_handleMouseDownPan(e){this._panStart.set(e.clientX,e.clientY)}_handleMouseMoveRotate(e){this._rotateEnd.set(e.clientX,e.clientY),this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let t=this.domElement;this._rotateLeft(mi*this._rotateDelta.x/t.clientHeight),this._rotateUp(mi*this._rotateDelta.y/t.clientHeight),this._rotateStart.copy(this._rotateEnd),this.update()}_handleMouseMoveDolly(e){this._dollyEnd.set(e.clientX,e.clientY),this._dollyDelta.subVectors(this._dollyEnd,this._dollyStart),this._dollyDelta.y>0?this._dollyOut(this._getZoomScale(this._dollyDelta.y)):this._dollyDelta.y<0&&this._dollyIn(this._getZoomScale(this._dollyDelta.y)),this._dollyStart.copy(this._dollyEnd),this.zoomToCursor&&(this._performCursorZoom=!0,this._dollyDirection.set(this._mouse.x,this._mouse.y,1).unproject(this.object).sub(this.object.position).normalize()),this.update()}_handleMouseMovePan(e){this._panEnd.set(e.clientX,e.clientY),this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd),this.update()}_handleMouseWheel(e){this._updateZoomParameters(e.clientX,e.clientY),e.deltaY<0?this._dollyIn(this._getZoomScale(e.deltaY)):e.deltaY>0&&this._dollyOut(this._getZoomScale(e.deltaY)),this.update()}_handleKeyDown(e){let t=!1;switch(e.code){case this.keys.UP:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateUp(mi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,this.keyPanSpeed),t=!0;break;case this.keys.BOTTOM:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateUp(-mi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(0,-this.keyPanSpeed),t=!0;break;case this.keys.LEFT:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateLeft(mi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(this.keyPanSpeed,0),t=!0;break;case this.keys.RIGHT:e.ctrlKey||e.metaKey||e.shiftKey?this.enableRotate&&this._rotateLeft(-mi*this.keyRotateSpeed/this.domElement.clientHeight):this.enablePan&&this._pan(-this.keyPanSpeed,0),t=!0;break}t&&(e.preventDefault(),this.update())}_handleTouchStartRotate(e){if(this._pointers.length===1)this._rotateStart.set(e.pageX,e.pageY);else{let t=this._getSecondPointerPosition(e),n=.5*(e.pageX+t.x),s=.5*(e.pageY+t.y);this._rotateStart.set(n,s)}}_handleTouchStartPan(e){if(this._pointers.length===1)this._panStart.set(e.pageX,e.pageY);else{let t=this._getSecondPointerPosition(e),n=.5*(e.pageX+t.x),s=.5*(e.pageY+t.y);this._panStart.set(n,s)}}_handleTouchStartDolly(e){let t=this._getSecondPointerPosition(e),n=e.pageX-t.x,s=e.pageY-t.y,r=Math.sqrt(n*n+s*s);this._dollyStart.set(0,r)}_handleTouchStartDollyPan(e){this.enableZoom&&this._handleTouchStartDolly(e),this.enablePan&&this._handleTouchStartPan(e)}_handleTouchStartDollyRotate(e){this.enableZoom&&this._handleTouchStartDolly(e),this.enableRotate&&this._handleTouchStartRotate(e)}_handleTouchMoveRotate(e){if(this._pointers.length==1)this._rotateEnd.set(e.pageX,e.pageY);else{let n=this._getSecondPointerPosition(e),s=.5*(e.pageX+n.x),r=.5*(e.pageY+n.y);this._rotateEnd.set(s,r)}this._rotateDelta.subVectors(this._rotateEnd,this._rotateStart).multiplyScalar(this.rotateSpeed);let t=this.domElement;this._rotateLeft(mi*this._rotateDelta.x/t.clientHeight),this._rotateUp(mi*this._rotateDelta.y/t.clientHeight),this._rotateStart.copy(this._rotateEnd)}_handleTouchMovePan(e){if(this._pointers.length===1)this._panEnd.set(e.pageX,e.pageY);else{let t=this._getSecondPointerPosition(e),n=.5*(e.pageX+t.x),s=.5*(e.pageY+t.y);this._panEnd.set(n,s)}this._panDelta.subVectors(this._panEnd,this._panStart).multiplyScalar(this.panSpeed),this._pan(this._panDelta.x,this._panDelta.y),this._panStart.copy(this._panEnd)}_handleTouchMoveDolly(e){let t=this._getSecondPointerPosition(e),n=e.pageX-t.x,s=e.pageY-t.y,r=Math.sqrt(n*n+s*s);this._dollyEnd.set(0,r),this._dollyDelta.set(0,Math.pow(this._dollyEnd.y/this._dollyStart.y,this.zoomSpeed)),this._dollyOut(this._dollyDelta.y),this._dollyStart.copy(this._dollyEnd);let o=(e.pageX+t.x)*.5,a=(e.pageY+t.y)*.5;this._updateZoomParameters(o,a)}_handleTouchMoveDollyPan(e){this.enableZoom&&this._handleTouchMoveDolly(e),this.enablePan&&this._handleTouchMovePan(e)}_handleTouchMoveDollyRotate(e){this.enableZoom&&this._handleTouchMoveDolly(e),this.enableRotate&&this._handleTouchMoveRotate(e)}_addPointer(e){this._pointers.push(e.pointerId)}_removePointer(e){delete this._pointerPositions[e.pointerId];for(let t=0;t<this._pointers.length;t++)if(this._pointers[t]==e.pointerId){this._pointers.splice(t,1);return}}_isTrackingPointer(e){for(let t=0;t<this._pointers.length;t++)if(this._pointers[t]==e.pointerId)return!0;return!1}_trackPointer(e){let t=this._pointerPositions[e.pointerId];t===void 0&&(t=new qe,this._pointerPositions[e.pointerId]=t),t.set(e.pageX,e.pageY)}_getSecondPointerPosition(e){let t=e.pointerId===this._pointers[0]?this._pointers[1]:this._pointers[0];return this._pointerPositions[t]}_customWheelEvent(e){let t=e.deltaMode,n={clientX:e.clientX,clientY:e.clientY,deltaY:e.deltaY};switch(t){case 1:n.deltaY*=16;break;case 2:n.deltaY*=100;break}return e.ctrlKey&&!this._controlActive&&(n.deltaY*=10),n}};function JA(i){this.enabled!==!1&&(this._pointers.length===0&&(this.domElement.setPointerCapture(i.pointerId),this.domElement.ownerDocument.addEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.addEventListener("pointerup",this._onPointerUp)),!this._isTrackingPointer(i)&&(this._addPointer(i),i.pointerType==="touch"?this._onTouchStart(i):this._onMouseDown(i),this._cursorStyle==="grab"&&(this.domElement.style.cursor="grabbing")))}function jA(i){this.enabled!==!1&&(i.pointerType==="touch"?this._onTouchMove(i):this._onMouseMove(i))}function QA(i){switch(this._removePointer(i),this._pointers.length){case 0:this.domElement.releasePointerCapture(i.pointerId),this.domElement.ownerDocument.removeEventListener("pointermove",this._onPointerMove),this.domElement.ownerDocument.removeEventListener("pointerup",this._onPointerUp),this.dispatchEvent(uy),this.state=It.NONE,this._cursorStyle==="grab"&&(this.domElement.style.cursor="grab");break;case 1:let e=this._pointers[0],t=this._pointerPositions[e];this._onTouchStart({pointerId:e,pageX:t.x,pageY:t.y});break}}function eE(i){let e;switch(i.button){case 0:e=this.mouseButtons.LEFT;break;case 1:e=this.mouseButtons.MIDDLE;break;case 2:e=this.mouseButtons.RIGHT;break;default:e=-1}switch(e){case ar.DOLLY:if(this.enableZoom===!1)return;this._handleMouseDownDolly(i),this.state=It.DOLLY;break;case ar.ROTATE:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=It.PAN}else{if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=It.ROTATE}break;case ar.PAN:if(i.ctrlKey||i.metaKey||i.shiftKey){if(this.enableRotate===!1)return;this._handleMouseDownRotate(i),this.state=It.ROTATE}else{if(this.enablePan===!1)return;this._handleMouseDownPan(i),this.state=It.PAN}break;default:this.state=It.NONE}this.state!==It.NONE&&this.dispatchEvent(Pd)}function tE(i){switch(this.state){case It.ROTATE:if(this.enableRotate===!1)return;this._handleMouseMoveRotate(i);break;case It.DOLLY:if(this.enableZoom===!1)return;this._handleMouseMoveDolly(i);break;case It.PAN:if(this.enablePan===!1)return;this._handleMouseMovePan(i);break}}function nE(i){this.enabled===!1||this.enableZoom===!1||this.state!==It.NONE||(i.preventDefault(),this.dispatchEvent(Pd),this._handleMouseWheel(this._customWheelEvent(i)),this.dispatchEvent(uy))}function iE(i){this.enabled!==!1&&this._handleKeyDown(i)}function sE(i){switch(this._trackPointer(i),this._pointers.length){case 1:switch(this.touches.ONE){case lr.ROTATE:if(this.enableRotate===!1){this.state=It.NONE;break}this._handleTouchStartRotate(i),this.state=It.TOUCH_ROTATE;break;case lr.PAN:if(this.enablePan===!1){this.state=It.NONE;break}this._handleTouchStartPan(i),this.state=It.TOUCH_PAN;break;default:this.state=It.NONE}break;case 2:switch(this.touches.TWO){case lr.DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchStartDollyPan(i),this.state=It.TOUCH_DOLLY_PAN;break;case lr.DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchStartDollyRotate(i),this.state=It.TOUCH_DOLLY_ROTATE;break;default:this.state=It.NONE}break;default:this.state=It.NONE}this.state!==It.NONE&&this.dispatchEvent(Pd)}function rE(i){switch(this._trackPointer(i),this.state){case It.TOUCH_ROTATE:if(this.enableRotate===!1)return;this._handleTouchMoveRotate(i),this.update();break;case It.TOUCH_PAN:if(this.enablePan===!1)return;this._handleTouchMovePan(i),this.update();break;case It.TOUCH_DOLLY_PAN:if(this.enableZoom===!1&&this.enablePan===!1)return;this._handleTouchMoveDollyPan(i),this.update();break;case It.TOUCH_DOLLY_ROTATE:if(this.enableZoom===!1&&this.enableRotate===!1)return;this._handleTouchMoveDollyRotate(i),this.update();break;default:this.state=It.NONE}}function oE(i){this.enabled!==!1&&i.preventDefault()}function aE(i){i.key==="Control"&&(this._controlActive=!0,this.domElement.ownerDocument.addEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}function lE(i){i.key==="Control"&&(this._controlActive=!1,this.domElement.ownerDocument.removeEventListener("keyup",this._interceptControlUp,{passive:!0,capture:!0}))}var Ld=1,$h=class{constructor(e){this.into=e;e.frustumCulled=!1,e.visible=!1}into;parts=[];fill(e,t,n){let s=0;for(let p of e){let g=p.geometry;s+=n?g.index?.count??g.getAttribute("position").count:g.getAttribute("position").count}let r=new Float32Array(3*s),o=n?new Float32Array(3*s):null,a=new Ht(new Float32Array(4*s),4);a.setUsage(Wo);let l=t.matrixWorld.clone().invert(),c=new Vt,h=new O,u=0;this.parts=e.map(p=>{let g=p.geometry;c.multiplyMatrices(l,p.matrixWorld);let x=g.getAttribute("position"),m=g.getAttribute("normal"),d=n?g.index:null,y=d?.count??x.count;for(let v=0;v<y;v++){let E=d?d.getX(v):v;h.fromBufferAttribute(x,E).applyMatrix4(c).toArray(r,3*(u+v)),o&&m&&h.fromBufferAttribute(m,E).transformDirection(c).toArray(o,3*(u+v))}let w={object:p,start:u,count:y,colour:-1,opacity:-1};return u+=y,w}),this.into.geometry.dispose();let f=new ct;f.setAttribute("position",new Ht(r,3)),o&&f.setAttribute("normal",new Ht(o,3)),f.setAttribute("color",a),this.into.geometry=f,this.into.visible=s>0}colour(){let e=this.into.geometry.getAttribute("color");if(e)for(let t of this.parts){let n=t.object.material,s=n.color.getHex();if(!(s===t.colour&&n.opacity===t.opacity)){t.colour=s,t.opacity=n.opacity;for(let r=t.start;r<t.start+t.count;r++)e.setXYZW(r,n.color.r,n.color.g,n.color.b,n.opacity);e.addUpdateRange(4*t.start,4*t.count),e.needsUpdate=!0}}}},qh=class{root=new wt;faces=new $h(new _t(new ct,new Xn({vertexColors:!0,transparent:!0,depthWrite:!1,side:di,forceSinglePass:!0})));lines=new $h(new Wn(new ct,new zn({vertexColors:!0,transparent:!0,depthWrite:!1})));members=[];constructor(){this.root.add(this.faces.into,this.lines.into)}take(e,t){for(let r of this.members)r.traverse(o=>o.layers.set(0));this.members=e;let n=[],s=[];t.updateWorldMatrix(!0,!0);for(let r of e)r.traverseVisible(o=>{o.isLineSegments?s.push(o):o.isMesh&&n.push(o),o.layers.set(Ld)});this.faces.fill(n,t,!0),this.lines.fill(s,t,!1),this.colour()}colour(){this.faces.colour(),this.lines.colour()}};var Yh=class{constructor(e,t,n=0){this.shift=n;this.face=new Xn({color:e,transparent:!0,opacity:t,side:di,forceSinglePass:!0,depthWrite:t>.8}),this.line=new zn({color:e,transparent:!0,opacity:Math.min(1,t+.35)}),this.thin=new zn({color:e,transparent:!0,opacity:.3}),this.thin.userData.opacity=.3,this.face.userData.opacity=t,this.line.userData.opacity=this.line.opacity}shift;face;line;thin;set(e,t){for(let n of[this.face,this.line,this.thin])n.color.setHex(e).offsetHSL(this.shift*.05,0,this.shift*.1),n.opacity=n.userData.opacity*t}solid(e){this.face.flatShading=e,this.face.userData.opacity=.92,this.face.depthWrite=!0,this.face.needsUpdate=!0}},Yo=new O(0,0,1);function sn(i,e,t=[0,0,0]){return new O(...Ll(i[e],t))}function fn(i,e,t=0){return Tt(i[e],t)}function kr(i,e,t=[0,0,1]){let n=sn(i,e,t);return n.lengthSq()>1e-18?n.normalize():new O(...t)}function Dd(i,e){let t=i[e];if(!Array.isArray(t)||t.length!==4)return new tn;let[n,s,r,o]=t.map(l=>Tt(l)),a=new tn(s,r,o,n);return a.lengthSq()>1e-12?a.normalize():new tn}function fy(i){return new tn().setFromUnitVectors(Yo,i)}function Zo(i){let e=Math.abs(i.z)<.9?new O(0,0,1):new O(1,0,0);return e.crossVectors(e,i).normalize(),[e,new O().crossVectors(i,e)]}function rn(i,e){let t=new ct;return t.setAttribute("position",new Ht(i instanceof Float32Array?i:new Float32Array(i),3)),new Wn(t,e)}function es(i,e){i.geometry.dispose(),i.geometry=e}function Br(i){let e=new ct;return e.setAttribute("position",new Ht(new Float32Array(i),3)),e}function Nd(i,e,t){let n=t.length();if(!(n>1e-9))return;let s=e.clone().add(t),[r]=Zo(t.clone().normalize()),o=t.clone().multiplyScalar(-.28),a=r.multiplyScalar(n*.12),l=s.clone().add(o).add(a),c=s.clone().add(o).sub(a);for(let[h,u]of[[e,s],[s,l],[s,c]])i.push(h.x,h.y,h.z,u.x,u.y,u.z)}function Ko(i){i.traverse(e=>{let t=e;t.geometry&&!t.geometry.userData.shared&&t.geometry.dispose();let n=t.material;n&&!Array.isArray(n)&&n.dispose()})}var Fd=8;function dy(){let i=Br([-.5,-.5,0,.5,-.5,0,.5,.5,0,-.5,.5,0]);return i.setIndex([0,1,2,0,2,3]),i.computeVertexNormals(),i}function py(){let i=[];for(let e=0;e<=Fd;e++){let t=e/Fd-.5;i.push(t,-.5,0,t,.5,0,-.5,t,0,.5,t,0)}return i.push(0,0,0,0,0,.14,0,0,.14,.025,0,.1,0,0,.14,-.025,0,.1),i}var ll=class{root=new wt;normal=new O(0,0,1);offset=0;u=new O(1,0,0);v=new O(0,1,0);constructor(e){this.root.add(new _t(dy(),e.face),rn(py(),e.line))}place(e,t){this.normal.copy(e),this.offset=t,[this.u,this.v]=Zo(e),this.root.quaternion.setFromRotationMatrix(this.root.matrix.makeBasis(this.u,this.v,this.normal))}follow(e){let t=.9*e.radius,n=t/Fd,s=r=>Math.round(r/n)*n;this.root.scale.setScalar(t),this.root.position.set(0,0,0).addScaledVector(this.u,s(e.hand.dot(this.u))).addScaledVector(this.v,s(e.hand.dot(this.v))).addScaledVector(this.normal,this.offset)}};function my(i){let e=new ll(i);return{root:e.root,update(t,n){let s=sn(t,"normal",[0,0,1]),r=s.length()||1;e.place(s.divideScalar(r),fn(t,"offset")/r),e.follow(n)},tick:t=>e.follow(t)}}function gy(i){let e=new wt,t=new _t(dy(),i.face),n=rn(py(),i.line),s=rn([.5,-.5,0,.5,.5,0],i.line);e.add(t,n,s);let r=new O(0,0,1),o=new O(1,0,0),a=new O(0,1,0),l=0,c=0,h=u=>{let f=.9*u.radius;e.scale.setScalar(f);let p=Math.min(c-f/2,u.hand.dot(o));e.position.set(0,0,0).addScaledVector(r,l).addScaledVector(o,p).addScaledVector(a,u.hand.dot(a))};return{root:e,update(u,f){r=sn(u,"normal",[0,0,1]);let p=r.length()||1;r.divideScalar(p),l=fn(u,"offset")/p;let g=sn(u,"edge",[1,0,0]),x=g.length()||1;g.divideScalar(x);let m=g.dot(r);o=g.clone().addScaledVector(r,-m);let d=o.length()||1;o.divideScalar(d),c=(fn(u,"edge_offset")/x-m*l)/d,a=new O().crossVectors(r,o),e.quaternion.setFromRotationMatrix(e.matrix.makeBasis(o,a,r)),h(f)},tick:h}}function yy(i){let e=new wt,t=new _t(new ct,i.face),n=rn([],i.line);return e.add(t,n),{root:e,update(s){let r=(Array.isArray(s.vertices)?s.vertices:[]).map(l=>Ll(l)),o=Br(r.flat()),a=[];for(let l=2;l<r.length;l++)a.push(0,l-1,l);o.setIndex(a),o.computeVertexNormals(),es(t,o),es(n,Br(r.flatMap((l,c)=>[...l,...r[(c+1)%r.length]])))}}}function Ud(i,e,t){let n=Math.abs(e);if(Math.abs(i)<1e-9)return 0;let s=o=>(1-Math.sqrt(Math.max(0,1-i*i*o*o)))/i;if(n<=t)return s(n);let r=i*t/Math.sqrt(Math.max(1e-9,1-i*i*t*t));return s(t)+r*(n-t)}function _y(i){let e=new wt,t=new _t(new ct,i.face),n=new Wn(new ct,i.line);e.add(t,n);let s=20;return{root:e,update(r,o){let a=kr(r,"normal"),l=sn(r,"axis"),c=fn(r,"curvature");l.addScaledVector(a,-l.dot(a));let h=l.lengthSq()>1e-18,u=h?fn(r,"curvature2"):c,f=h?l.normalize():Zo(a)[0],p=new O().crossVectors(a,f);e.position.copy(sn(r,"foot")),e.quaternion.copy(new tn().setFromRotationMatrix(e.matrix.makeBasis(f,p,a)));let g=Math.max(Math.abs(c),Math.abs(u)),x=Math.min(.5,Tt(r.rim,.15)),m=g>1e-9?x/g:1/0,d=Math.min(.35*o.radius,Math.max(3*m,.08*o.radius)),y=[];for(let M=0;M<=s;M++)for(let D=0;D<=s;D++){let I=2*D/s-1,L=2*M/s-1,k=d*I*Math.sqrt(1-L*L/2),V=d*L*Math.sqrt(1-I*I/2),R=h?Ud(c,k,m)+Ud(u,V,m):Ud(c,Math.hypot(k,V),m);y.push(k,V,R)}let w=[],v=[],E=(M,D)=>D*(s+1)+M;for(let M=0;M<=s;M++)for(let D=0;D<=s;D++)D<s&&M<s&&w.push(E(D,M),E(D+1,M),E(D+1,M+1),E(D,M),E(D+1,M+1),E(D,M+1)),D<s&&M%5===0&&v.push(E(D,M),E(D+1,M)),M<s&&D%5===0&&v.push(E(D,M),E(D,M+1));let S=Br(y);S.setIndex(w),S.computeVertexNormals(),es(t,S);let _=new ct;_.setAttribute("position",new Ht(new Float32Array(v.flatMap(M=>y.slice(3*M,3*M+3))),3)),es(n,_)}}}function cE(i,e){let t=[],n=i*10,s=r=>{let o=r/n,a=e*Math.min(1,8*o,8*(1-o));return[a*Math.cos(2*Math.PI*r/10),a*Math.sin(2*Math.PI*r/10),o]};for(let r=0;r<n;r++)t.push(...s(r),...s(r+1));return t}function xy(i){let e=new wt,t=new _t(new Ri(1,16,12),i.face);i.face.userData.opacity=.9;let n=rn(cE(9,1),i.line);n.frustumCulled=!1,e.add(t,n);let s=new O,r=new O,o=a=>{r.subVectors(a.hand,s);let l=r.length();n.visible=l>1e-5,n.position.copy(s),n.visible&&n.quaternion.setFromUnitVectors(Yo,r.divideScalar(l));let c=.03*a.radius;n.scale.set(c,c,Math.max(1e-6,l))};return{root:e,update(a,l){s.copy(sn(a,"anchor")),t.position.copy(s),t.scale.setScalar(.03*l.radius),o(l)},tick:o}}function vy(i){let e=new wt,t=new _t(new Ri(1,24,16),i.face),n=rn(by(),i.thin),s=rn([0,0,0,0,0,1],i.line);s.frustumCulled=!1,e.add(t,n,s);let r=new O,o=0,a=l=>{let c=new O().subVectors(l.hand,r),h=c.length();s.visible=h>1e-6&&h<o,s.visible&&(s.quaternion.setFromUnitVectors(Yo,c.divideScalar(h)),s.scale.set(1,1,h),s.position.copy(r))};return{root:e,update(l,c){r.copy(sn(l,"position"));let h=fn(l,"radius");o=h+fn(l,"max_distance",.02),t.position.copy(r),t.scale.setScalar(Math.max(h,.02*c.radius)),n.position.copy(r),n.scale.setScalar(o),a(c)},tick:a}}function by(){let i=[];for(let e=0;e<60;e+=2){let[t,n]=[2*Math.PI*e/60,2*Math.PI*(e+1)/60],[s,r,o,a]=[Math.cos(t),Math.sin(t),Math.cos(n),Math.sin(n)];i.push(s,r,0,o,a,0,s,0,r,o,0,a,0,s,r,0,o,a)}return i}function My(i){let e=new wt,t=new _t(new Lr(1),i.face);i.face.userData.opacity=.35;let n=new ll(i),s=rn([0,0,-1,0,0,1],i.line),r=rn([0,0,0,0,0,1],i.line);s.frustumCulled=r.frustumCulled=!1,e.add(t,n.root,s,r);let o=new O,a=new O,l="point",c=h=>{let f=new O().subVectors(h.hand,o).dot(a),p=l==="point"?o.clone():l==="line"?o.clone().addScaledVector(a,f):h.hand.clone().addScaledVector(a,-f),g=new O().subVectors(h.hand,p),x=g.length();r.visible=x>1e-6,r.position.copy(p),r.visible&&r.quaternion.setFromUnitVectors(Yo,g.divideScalar(x)),r.scale.set(1,1,Math.max(1e-6,x)),t.position.copy(p),l==="plane"&&n.follow(h)};return{root:e,update(h,u){l=String(h.shape??"point"),o.copy(sn(h,"origin")),a.copy(kr(h,"direction")),t.scale.setScalar(.025*u.radius),n.root.visible=l==="plane",s.visible=l==="line",s.position.copy(o),s.quaternion.setFromUnitVectors(Yo,a),s.scale.set(1,1,2*u.radius),l==="plane"&&n.place(a,o.dot(a)),c(u)},tick:c}}function Sy(i,e,t,n,s){let r=[],o=t>1?2*e/(t-1):0;for(let a=0;a<t;a++)for(let l=0;l<t;l++)for(let c=0;c<t;c++){let h=new O(a*o-e,l*o-e,c*o-e);if(t===1&&h.set(0,0,0),h.length()>e*1.01)continue;let u=h.add(i),f=s(u),p=f.length();p<1e-6*n||Nd(r,u,f.multiplyScalar(.85*(o||e)*Math.min(1,Math.sqrt(p/n))/p))}return Br(r)}function hE(i){let e=Math.min(1,Math.max(0,(1-i)/.2));return e*e*(3-2*e)}function Od(i){let e=new wt,t=new Wn(new ct,i.line),n=rn(by(),i.thin);return e.add(t,n),{root:e,update(s,r){let o=sn(s,"origin"),a=sn(s,"force"),l=s.jacobian?.flat().map(x=>Tt(x))??[],c=l.length===36?6:3,h=fn(s,"radius",.05),u=Math.min(h,1.2*r.radius),f=s.edge==="hold",p=x=>{let m=new O().subVectors(x,o),d=m.length(),y=v=>(l[v*c]??0)*m.x+(l[v*c+1]??0)*m.y+(l[v*c+2]??0)*m.z,w=new O(a.x+y(0),a.y+y(1),a.z+y(2));return f?w:w.multiplyScalar(hE(d/h)||(d<h?.02:0))},g=1e-9;for(let x=0;x<27;x++){let m=new O(x%3-1,Math.floor(x/3)%3-1,Math.floor(x/9)-1).multiplyScalar(.45*u);g=Math.max(g,p(m.add(o)).length())}es(t,Sy(o,u,6,g,p)),n.position.copy(o),n.scale.setScalar(u)}}}function wy(i,e){let t=new wt,n=new Wn(new ct,i.line);return t.add(n),{root:t,update(s,r){let o=e(s);es(n,Sy(r.centre,r.radius,4,r.peakForce,()=>o.clone()))}}}var Ay=i=>wy(i,e=>sn(e,"force")),Ey=i=>wy(i,e=>sn(e,"acceleration",[0,0,-9.81]).multiplyScalar(fn(e,"mass")));function Ty(i){let e=new wt,t=rn(uE(),i.line),n=rn(new Float32Array(18),i.line);n.frustumCulled=!1,e.add(t,n);let s=0,r=o=>{t.position.copy(o.hand),t.scale.setScalar(.3*o.radius);let a=[];Nd(a,o.hand,o.velocity.clone().multiplyScalar(-s*o.radius/o.peakForce));let l=n.geometry.getAttribute("position");n.visible=a.length>0,l.array.set(a),l.needsUpdate=!0};return{root:e,update(o,a){s=fn(o,"damping"),i.line.userData.opacity=.25+.5*Math.min(1,s/10),r(a)},tick:r}}function uE(){let i=[];for(let e=0;e<120;e++){let t=1-2*(e+.5)/120,n=e*2.39996,s=Math.cbrt(e*37%120/120),r=Math.sqrt(1-t*t),o=[r*Math.cos(n)*s,r*Math.sin(n)*s,t*s];i.push(...o,o[0]+.03,o[1],o[2])}return i}function Cy(i){let e=new wt,t=[];for(let a=0;a<64;a++){let l=c=>[.12*Math.sin(c/64*8*Math.PI)*(1-Math.abs(2*c/64-1)),0,c/32-1];t.push(...l(a),...l(a+1))}let n=rn(t,i.line);n.frustumCulled=!1,e.add(n);let s=new O,r=0,o=a=>{let l=.4*a.radius*Math.min(1,Math.sqrt(r/a.peakForce)+.2);n.position.copy(a.hand),n.scale.set(l*(1+.3*Math.sin(a.time*20)),l,l)};return{root:e,update(a,l){s.copy(kr(a,"direction"));let[c,h]=Zo(s);n.quaternion.setFromRotationMatrix(n.matrix.makeBasis(c,h,s)),r=fn(a,"amplitude"),n.visible=r>0,o(l)},tick:o}}function Zh(i,e,t,n=30){let s=new wt,r=new _t(new ct,i.face),o=new Wn(new ct,i.line);return s.add(r,o),{root:s,update(a,l){let c=e(a,l);es(r,c),es(o,new za(c,n));let h=a.side==="inside";i.face.userData.opacity=h?.1:.45,t(s,a)}}}var ur=2e-4,Ry=i=>Zh(i,e=>{let t=sn(e,"half_size",[.05,.05,.05]);return new tr(Math.max(ur,2*t.x),Math.max(ur,2*t.y),Math.max(ur,2*t.z))},(e,t)=>{e.position.copy(sn(t,"center")),e.quaternion.copy(Dd(t,"orientation"))},1);function fE(i){let e=[];for(let n=0;n<48;n++){let[s,r]=[2*Math.PI*n/48,2*Math.PI*(n+1)/48],[o,a,l,c]=[Math.cos(s),Math.sin(s),Math.cos(r),Math.sin(r)].map(h=>h*i);e.push(o,a,0,l,c,0,o,0,a,l,0,c,0,o,a,0,l,c)}return e}function Iy(i){let e=new wt,t=new _t(new Ri(1,32,20),i.face),n=rn(fE(1),i.line);return e.add(t,n),{root:e,update(s){let r=s.side==="inside";i.face.userData.opacity=r?.1:.45,e.position.copy(sn(s,"center")),e.scale.setScalar(Math.max(ur,fn(s,"radius",.01)))}}}var kd=(i,e)=>{i.position.copy(sn(e,"center")),i.quaternion.copy(fy(kr(e,"axis")))},Py=i=>Zh(i,e=>new Ba(Math.max(ur,fn(e,"radius",.01)),2*fn(e,"half_length",.02),8,20).rotateX(Math.PI/2),kd),Ly=i=>Zh(i,(e,t)=>{let n=fn(e,"half_length",.02),s=Math.max(ur,fn(e,"radius",.01));return new nr(s,s,Number.isFinite(n)?Math.max(ur,2*n):4*t.radius,32,1,!Number.isFinite(n)).rotateX(Math.PI/2)},kd),Dy=i=>Zh(i,e=>new ir(fn(e,"radius",.02),Math.max(ur,fn(e,"tube",.005)),16,48),kd,80);function Ny(i){let e=new wt,t=new _t(new Lr(1),i.face);e.add(t);let n=new _t(new ct,i.face);n.name="asset";let s=0,r=!1,o=!1,a=l=>{if(o)return;let c=l.asset(s,r);c&&(o=!0,n.geometry=c,e.remove(t),e.add(n),i.solid(!r))};return{root:e,update(l,c){let h=fn(l,"asset"),u=l.shading==="smooth";(h!==s||u!==r)&&(o=!1,e.remove(n),e.add(t)),s=h,r=u,t.scale.setScalar(.03*c.radius),e.position.copy(sn(l,"position")),e.quaternion.copy(Dd(l,"orientation")),a(c)},tick:a}}function Uy(i,e){let t=sn(i,"velocity");return t.lengthSq()>0?t.multiplyScalar(e):null}var dE={plane:my,cap:_y,polygon:yy,half_plane:gy,box:Ry,sphere:Iy,capsule:Py,cylinder:Ly,torus:Dy,shape:Ny,spring:xy,magnet:vy,constraint:My,taylor:Od,taylor6:Od,constant_force:Ay,gravity:Ey,viscosity:Ty,vibration:Cy};function pE(i){let e=new wt;return e.add(rn([-1,0,0,1,0,0,0,-1,0,0,1,0,0,0,-1,0,0,1],i.line)),{root:e,update(t,n){let s=Object.entries(t).find(([,r])=>Array.isArray(r)&&r.length===3);s&&e.position.copy(sn(t,s[0])),e.scale.setScalar(.1*n.radius)}}}function Fy(i,e){return(dE[i]??pE)(e)}var Bd=new Float32Array(Array.from({length:256},(i,e)=>km(e/255)).flat()),Kh=800,mE=4,Oy=700,gE=12,Jh=class{constructor(e,t){this.device=e;this.assets=t;let{i:n,radius:s,centre:r}=e.info,o=(l,c)=>(l.name=`${c}:${n}`,l);o(this.root,"device"),this.root.add(this.batch.root),this.hand=o(new _t(new Ri(.028*s,24,16),new Xn),"hand"),this.ring=o(new _t(new ir(.05*s,.004*s,8,32),new Xn),"orientation"),this.contact=o(new _t(new Ri(.02*s,16,12),new Xn),"contact"),this.proxy=o(rn([0,0,0,0,0,1],new zn),"proxy"),this.pull=o(rn([0,0,0,0,0,1],new zn),"pull"),this.workspace=o(rn(yE(),new zn({transparent:!0,opacity:.7})),"workspace"),this.workspace.position.set(...r),this.workspace.scale.setScalar(s),this.floor=o(rn(_E(),new zn({transparent:!0,opacity:.6})),"floor"),this.floor.position.set(r[0],r[1],r[2]-s),this.floor.scale.setScalar(s),o(this.force.root,"force"),o(this.sceneForce.root,"scene_force"),o(this.arm,"arm"),this.armLine=new Ir(new ct,new zn),this.arm.add(this.armLine),o(this.torque,"torque").add(new _t(new ir(1,.04,8,32,4.8),new Xn),new _t(new Pr(.14,.3,12),new Xn)),this.torque.children[1].position.set(Math.cos(4.8),Math.sin(4.8),0),this.torque.children[1].rotation.z=4.8;let a=new ct;a.setAttribute("position",new Ht(new Float32Array(3*Kh),3).setUsage(Wo)),a.setAttribute("color",new Ht(new Float32Array(3*Kh),3).setUsage(Wo)),this.trail=o(new Ir(a,new zn({vertexColors:!0})),"trail"),this.axes=o(new Wn(zy(),new zn({vertexColors:!0})),"frame"),this.axes.scale.setScalar(.2*s),this.root.add(this.axes);for(let l of[this.trail,this.proxy,this.pull,this.armLine])l.frustumCulled=!1;this.root.add(this.workspace,this.floor,this.arm,this.trail,this.proxy,this.pull,this.contact,this.force.root,this.sceneForce.root,this.torque,this.ring,this.hand),this.colour()}device;assets;root=new wt;hand;ring;contact;proxy;force=new jh;sceneForce=new jh;torque=new wt;pull;arm=new wt;armLine;workspace;floor;trail;axes;claims=new Map;drawn=new Map;seen=-1;batch=new qh;batched="";nextBatch=0;place=new O;target=null;trailCount=-1;trailCursor=-1;colour(){let e=Yn();this.hand.material.color.setHex(e.hand),this.ring.material.color.setHex(e.arm),this.contact.material.color.setHex(e.contact),this.proxy.material.color.setHex(e.contact),this.pull.material.color.setHex(e.mine),this.workspace.material.color.setHex(e.workspace),this.floor.material.color.setHex(e.grid),this.armLine.material.color.setHex(e.arm),this.force.paint(e.force),this.sceneForce.paint(e.workspace);for(let t of this.torque.children)t.material.color.setHex(e.torque);for(let t of this.drawn.values())t.look=""}surroundings(e,t,n){let{scale:s,device_centre:r,world_centre:o,force_scale:a}=e.frame,l=h=>new O((h[0]-r[0])*s+o[0],(h[1]-r[1])*s+o[1],(h[2]-r[2])*s+o[2]),c=this.device.info;return{hand:l(t?.p??c.centre),velocity:t?new O(...t.v).multiplyScalar(s):new O,centre:l(c.centre),radius:c.radius*s,peakForce:(c.peak_force||8)*(a||1),time:n,asset:(h,u)=>this.assets(c.i,e.claim,h,u)}}groupOf(e){let t=this.claims.get(e.claim);t||(t={root:new wt,probes:[],claim:e},t.root.name=`claim:${e.claim}`,this.claims.set(e.claim,t),this.root.add(t.root)),t.claim=e;let{scale:n,device_centre:s,world_centre:r}=e.frame;t.root.scale.setScalar(1/n);let o=n!==1||s.some((l,c)=>l!==r[c]),a=t.root.getObjectByName(`frame:${e.claim}:claim`);return o&&!a&&(a=new Wn(zy(),new zn({vertexColors:!0})),a.name=`frame:${e.claim}:claim`,t.root.add(a)),a&&(a.visible=o,a.scale.setScalar(.14*this.device.info.radius*n)),t.root.position.set(s[0]-r[0]/n,s[1]-r[1]/n,s[2]-r[2]/n),t}reconcile(){for(let[e,t]of this.drawn){let n=this.device.items.get(e);if(n&&n.kind===t.item.kind&&n.generation===t.item.generation){t.item=n;continue}t.drawing.root.removeFromParent(),Ko(t.drawing.root),this.drawn.delete(e)}for(let[e,t]of this.claims)this.device.claims.has(e)||(Ko(t.root),t.root.removeFromParent(),this.claims.delete(e));for(let e of this.device.claims.values()){let t=this.groupOf(e);for(let n of t.probes)Ko(n),n.removeFromParent();t.probes=e.probes.map(([n,,s])=>{let r=Math.max(s/e.frame.scale,.012*this.device.info.radius),o=new _t(new Ri(r,16,12),new Xn({transparent:!0,opacity:.5,color:Yn().contact}));return o.name=`probe:${e.claim}:${n}`,this.root.add(o),o})}for(let[e,t]of this.device.items){if(this.drawn.has(e))continue;let n=this.device.claims.get(t.claim);if(!n)continue;let s=!["spring","constant_force","taylor","taylor6","viscosity","gravity","magnet","constraint","vibration"].includes(t.kind),r=new Yh(16777215,s?.45:.5,2*(t.slot*.618%1)-1);["plane","half_plane"].includes(t.kind)&&(r.face.userData.opacity=.16);let o=Fy(t.kind,r);o.root.name=`item:${t.claim}:${t.slot}`,o.root.userData.item=e,this.groupOf(n).root.add(o.root),this.drawn.set(e,{item:t,drawing:o,paint:r,version:-1,look:"",changed:performance.now()})}}update(e,t,n,s,r){let o=this.device.version!==this.seen;o&&(this.reconcile(),this.seen=this.device.version),this.workspace.material.opacity=s?.8:.35;let a=Yn(),l=this.device.info,c=new Map;for(let m of this.device.claims.values())c.set(m.claim,this.surroundings(m,e,n));let h=performance.now(),u=!1,f=!1;for(let m of this.drawn.values()){let{item:d,drawing:y,paint:w}=m,v=c.get(d.claim),E=this.device.claims.get(d.claim);if(!v||!E)continue;if(m.version!==d.version?(y.update(d.params,v),m.version=d.version,m.look="",m.changed=h,f=!0):y.tick?.(v),d.params.velocity&&Number.isFinite(d.since)){let D=Uy(d.params,(h-d.since)/1e3);D&&(y.update(d.params,v),y.root.position.add(D),m.changed=h,f=!0)}let S=Wm(d,r(E)),_=`${S} ${E.mine} ${y.root.children.length}`;if(_===m.look)continue;m.look=_,u=!0;let M=E.mine?a.mine:a.claims[E.row%a.claims.length];w.set(S==="asleep"?a.asleep:M,S==="faded"?.25:S==="asleep"?.5:S==="touched"?1.7:1),y.root.userData.mood=S}u&&this.batch.colour(),this.gather(h,f||o);for(let m of[this.hand,this.ring,this.force.root,this.sceneForce.root,this.arm])m.visible=e!==null;if(this.contact.visible=this.proxy.visible=this.torque.visible=this.pull.visible=!1,this.updateTrail(t),!e)return;this.place.set(...e.p),this.hand.position.copy(this.place),this.ring.position.copy(this.place),this.ring.quaternion.copy(ky(e)),this.ring.visible=l.senses_orientation;for(let m of this.claims.values())m.claim.probes.forEach(([,d],y)=>m.probes[y].position.set(...d).divideScalar(m.claim.frame.scale).applyQuaternion(ky(e)).add(this.place));e.flags.includes("touching")&&(this.contact.visible=!0,this.contact.position.set(...e.contact),By(this.proxy,this.place,this.contact.position));let g=2*l.radius/(l.peak_force||8);this.force.point(this.place,e.force,g,.012*l.radius),this.sceneForce.point(this.place,e.scene_force,g,.006*l.radius),Math.hypot(...e.scene_force.map((m,d)=>m-e.force[d]))<.02*(l.peak_force||8)&&(this.sceneForce.root.visible=!1);let x=Math.hypot(...e.torque);this.torque.visible=x>.001,this.torque.visible&&(this.torque.position.copy(this.place),this.torque.quaternion.setFromUnitVectors(new O(0,0,1),new O(...e.torque).divideScalar(x)),this.torque.scale.setScalar(l.radius*.25*Math.min(1,.3+x/(l.peak_torque||.2)))),this.updateArm(e),this.target&&By(this.pull,this.place,this.target)}gather(e,t){if(!t&&e<this.nextBatch)return;this.nextBatch=e+Oy;let n=[...this.drawn].filter(([,o])=>!o.drawing.tick&&o.item.kind!=="shape"&&e-o.changed>Oy),s=n.length<gE?[]:n,r=s.map(([o,a])=>`${o}:${a.item.generation}:${a.version}`).join();r!==this.batched&&(this.batched=r,this.batch.take(s.map(([,o])=>o.drawing.root),this.root))}updateArm(e){let t=e.arm??[];if(this.arm.visible=t.length>1,!this.arm.visible)return;let s=this.armLine.geometry.getAttribute("position");if(!s||s.count!==t.length){this.armLine.geometry.dispose(),this.armLine.geometry=new ct,this.armLine.geometry.setAttribute("position",new Ht(new Float32Array(t.length*3),3));for(let a of this.arm.children.slice(1))Ko(a),a.removeFromParent();for(let a=0;a<t.length;a++)if(this.arm.add(new _t(new Ri(.022*this.device.info.radius,12,8),new Xn({color:Yn().arm}))),a>0){let l=new _t(new Pr(.022*this.device.info.radius,1,10).translate(0,.5,0),new Xn({color:Yn().arm,transparent:!0,opacity:.55}));l.userData.link=a,this.arm.add(l)}}let r=this.armLine.geometry.getAttribute("position");t.forEach((a,l)=>r.setXYZ(l,...a)),r.needsUpdate=!0;let o=0;for(let a of this.arm.children.slice(1)){let l=a.userData.link;if(l===void 0)a.position.set(...t[o++]);else{let c=new O(...t[l-1]),h=new O(...t[l]).sub(c),u=h.length();a.visible=u>1e-6,a.position.copy(c),a.scale.set(1,Math.max(u,1e-6),1),a.visible&&a.quaternion.setFromUnitVectors(new O(0,1,0),h.divideScalar(u))}}}updateTrail(e){let t=this.device.history;if(t.count===this.trailCount&&e===this.trailCursor)return;this.trailCount=t.count,this.trailCursor=e;let n=t.find(e-mE),s=Math.min(t.held,t.find(e+1e-6)),r=Math.max(1,Math.ceil((s-n)/Kh)),o=this.trail.geometry.getAttribute("position"),a=this.trail.geometry.getAttribute("color"),l=t.columns,c=this.device.info.peak_force||8,h=0,u=n+(r-(t.count-t.held+n)%r)%r;for(let f=u;f<s&&h<Kh;f+=r){let p=t.place(f);o.setXYZ(h,l.px[p],l.py[p],l.pz[p]);let g=3*Math.min(255,Math.round(255*Math.sqrt(l.fx[p]**2+l.fy[p]**2+l.fz[p]**2)/c));a.setXYZ(h,Bd[g],Bd[g+1],Bd[g+2]),h++}o.needsUpdate=a.needsUpdate=!0,this.trail.geometry.setDrawRange(0,h)}get count(){return this.drawn.size}drawnItem(e){return this.drawn.get(e)}key(e){return po(e.claim,e.slot)}dispose(){this.root.removeFromParent(),Ko(this.root)}};function ky(i){return new tn(i.q[1],i.q[2],i.q[3],i.q[0]).normalize()}function By(i,e,t){let n=new O().subVectors(t,e),s=n.length();i.visible=s>1e-6,i.visible&&(i.position.copy(e),i.quaternion.setFromUnitVectors(new O(0,0,1),n.divideScalar(s)),i.scale.set(1,1,s))}var jh=class{root=new wt;material=new Xn;shaft=new _t(new nr(1,1,1,10).translate(0,.5,0).rotateX(Math.PI/2),this.material);head=new _t(new Pr(2.6,1,14).translate(0,-.5,0).rotateX(Math.PI/2),this.material);constructor(){this.root.add(this.shaft,this.head)}paint(e){this.material.color.setHex(e)}point(e,t,n,s){let r=new O(t[0],t[1],t[2]),o=r.length();if(this.root.visible=o>.005,!this.root.visible)return;let a=o*n,l=Math.min(.6*a,7*s);this.root.position.copy(e),this.root.quaternion.setFromUnitVectors(new O(0,0,1),r.divideScalar(o)),this.shaft.scale.set(s,s,Math.max(1e-9,a-l)),this.head.position.z=a,this.head.scale.set(s,s,l)}};function zy(){let i=new ct;return i.setAttribute("position",new Ht(new Float32Array([0,0,0,1,0,0,0,0,0,0,1,0,0,0,0,0,0,1]),3)),i.setAttribute("color",new Ht(new Float32Array([1,.3,.25,1,.3,.25,.3,.75,.35,.3,.75,.35,.3,.55,1,.3,.55,1]),3)),i}function yE(){let i=[];for(let t=0;t<72;t++){let[n,s]=[2*Math.PI*t/72,2*Math.PI*(t+1)/72],[r,o,a,l]=[Math.cos(n),Math.sin(n),Math.cos(s),Math.sin(s)];i.push(r,o,0,a,l,0,r,0,o,a,0,l,0,r,o,0,a,l)}return i}function _E(){let i=[];for(let e=-5;e<=5;e++)i.push(e/5,-1,0,e/5,1,0,-1,e/5,0,1,e/5,0);return i}var xE=2e4;function vE(){let i=document.createElement("canvas").getContext("webgl2"),e=i?.getExtension("WEBGL_debug_renderer_info"),t=i&&e?String(i.getParameter(e.UNMASKED_RENDERER_WEBGL)):"";return i?.getExtension("WEBGL_lose_context")?.loseContext(),/swiftshader|llvmpipe|software|softpipe/i.test(t)}var Qh=class{constructor(e,t,n,s){this.canvas=e;this.model=t;this.parts=n;this.events=s;this.scene.name="knurl",this.ray.layers.enable(Ld),this.camera.up.set(0,0,1),this.camera.position.set(.4,0,.12);try{let r=vE();this.renderer=new Vh({canvas:e,antialias:!r}),this.renderer.setPixelRatio(r?1:Math.min(2,window.devicePixelRatio))}catch{s.say("error","This browser gives no WebGL, so nothing is drawn in 3D; charts, panel and playground work.")}this.controls=new Xh(this.camera,e),this.controls.enableDamping=!1,this.controls.zoomSpeed=.8,this.light.position.set(.6,-.4,1),this.scene.add(new qa(16777215,1.6),this.light),this.gizmo=n.gizmo.getContext("2d"),Rl(()=>this.colour()),this.colour(),this.listen()}canvas;model;parts;events;scene=new Da;camera=new ci(40,1,1e-4,100);renderer=null;controls;views=new Map;light=new $a(16777215,2.2);assets=new Map;ray=new Ya;follow=!1;fitted=null;pointer=null;lookedAt=0;grip=null;gizmo;hovered="";by=null;height=1;turnedTo=new tn(0,0,0,0);colour(){this.scene.background=new dt(Yn().background);for(let e of this.views.values())e.colour();this.turnedTo.set(0,0,0,0)}asset(e,t,n,s){if(n===0)return null;let r=`./asset/${e}/${t}/${n}`,o=r+(s?"#smooth":""),a=this.assets.get(o);return a&&typeof a!="string"?a:(a===void 0&&(this.assets.set(o,"asked"),this.load(e<0?`${t}/${n}`:null,r,o,s)),null)}async bytesOf(e,t){if(e!==null)return this.model.recordedMeshes.get(e)??null;let n=await fetch(t);if(n.status===404)return null;if(!n.ok)throw new Error(`${n.status} ${n.statusText}`);return n.arrayBuffer()}async load(e,t,n,s){try{let r=await this.bytesOf(e,t);if(r===null){window.setTimeout(()=>this.assets.delete(n),1e3);return}let{positions:o,indices:a}=Hm(r),l=new ct;l.setAttribute("position",new Ht(o,3)),l.setIndex(new Ht(a,1)),l.userData.shared=!0,l.computeBoundingSphere(),l.computeBoundingBox(),s&&l.computeVertexNormals(),this.assets.set(n,l)}catch(r){this.assets.set(n,"none"),this.events.say("error",`The mesh ${t.slice(2)} cannot be drawn: ${r instanceof Error?r.message:String(r)}`)}}forgetAssets(){for(let e of this.assets.values())typeof e!="string"&&e.dispose();this.assets.clear()}layout(){let e=this.model.shown();for(let[s,r]of this.views)e.includes(s)||(r.dispose(),this.views.delete(s));let t=0;e.forEach((s,r)=>{let o=this.views.get(s);o||(o=new Jh(s,(...a)=>this.asset(...a)),this.views.set(s,o),this.scene.add(o.root)),r>0&&(t+=1.3*(s.info.radius+e[r-1].info.radius)),o.root.position.set(0,t,0)});let n=this.model.current();n&&n!==this.fitted&&(this.fitted=n,this.fit())}frameOf(e){return e===this.model.recording?e.history.held&&e.frame||Ul(e,e.history.find(this.model.cursor)):e.frame}draw(e){this.layout();for(let[t,n]of this.views){let s=new Map;for(let o of t.status?.clients??[])s.set(o.row,o.silent||o.shed);let r=o=>s.get(o.row)??!1;n.update(this.frameOf(t),t===this.model.recording?this.model.cursor:t.history.last,e,t===this.model.current(),r)}this.follow&&this.centreOnHand(),this.controls.update(),this.light.position.copy(this.camera.position).add(new O(0,-.2,.4)),this.renderer?.render(this.scene,this.camera),this.drawScale(),this.drawGizmo(),this.pointer&&e-this.lookedAt>.12&&!this.grip&&(this.lookedAt=e,this.hover(this.pointer.x,this.pointer.y))}resize(){let{clientWidth:e,clientHeight:t}=this.canvas;!e||!t||(this.height=t,this.camera.aspect=e/t,this.camera.updateProjectionMatrix(),this.renderer?.setSize(e,t,!1))}viewOf(e){return e&&this.views.get(e)}middle(e){let t=this.viewOf(e);return new O(...e.info.centre).add(t?.root.position??new O)}fit(){let e=this.model.current();if(!e)return;let t=this.middle(e),n=1.45*e.info.radius/Math.tan(this.camera.fov*Math.PI/360)/Math.min(1,this.camera.aspect);this.controls.target.copy(t),this.camera.position.copy(t).add(new O(.9,.16,.4).normalize().multiplyScalar(n)),this.camera.near=n/300,this.camera.far=n*60,this.camera.updateProjectionMatrix(),this.controls.update()}look(e){let t=this.camera.position.distanceTo(this.controls.target),n={x:new O(1,0,0),y:new O(0,1,0),z:new O(.001,0,1)}[e];this.camera.position.copy(this.controls.target).addScaledVector(n,t),this.controls.update()}toggleFollow(){return this.follow=!this.follow,this.follow}centreOnHand(){let e=this.model.current(),t=this.viewOf(e);if(!e||!t||!this.frameOf(e))return;let n=t.hand.getWorldPosition(new O).sub(this.controls.target).multiplyScalar(.15);this.controls.target.add(n),this.camera.position.add(n)}drawScale(){if(!this.model.current())return;let n=2*this.camera.position.distanceTo(this.controls.target)*Math.tan(this.camera.fov*Math.PI/360)/this.height,s=110*n,r=10**Math.floor(Math.log10(s)),o=[5,2,1].map(c=>c*r).find(c=>c<=s)??r,a=o>=1?`${o} m`:o>=.001?`${+(o*1e3).toPrecision(2)} mm`:`${+(o*1e6).toPrecision(2)} µm`,l=`${Math.round(o/n)}px`;this.parts.scale.textContent!==a&&(this.parts.scale.textContent=a),this.parts.scale.style.width!==l&&(this.parts.scale.style.width=l)}drawGizmo(){let e=this.gizmo;if(!e||this.turnedTo.equals(this.camera.quaternion))return;this.turnedTo.copy(this.camera.quaternion);let t=132;this.parts.gizmo.width!==t&&(this.parts.gizmo.width=this.parts.gizmo.height=t),e.clearRect(0,0,t,t);let n=[["x",new O(1,0,0),Yn().axes[0]],["y",new O(0,1,0),Yn().axes[1]],["z",new O(0,0,1),Yn().axes[2]]],s=this.camera.quaternion.clone().invert(),r=n.map(([o,a,l])=>({name:o,v:a.applyQuaternion(s),colour:l})).sort((o,a)=>o.v.z-a.v.z);e.font="bold 20px system-ui, sans-serif",e.textAlign="center",e.textBaseline="middle",e.lineWidth=4;for(let{name:o,v:a,colour:l}of r)e.strokeStyle=e.fillStyle=l,e.globalAlpha=a.z<-.2?.5:1,e.beginPath(),e.moveTo(t/2,t/2),e.lineTo(t/2+42*a.x,t/2-42*a.y),e.stroke(),e.fillText(o,t/2+55*a.x,t/2-55*a.y);e.globalAlpha=1}at(e,t){let n=this.canvas.getBoundingClientRect();this.ray.setFromCamera(new qe((e-n.left)/n.width*2-1,1-(t-n.top)/n.height*2),this.camera)}itemAt(e,t){this.at(e,t),this.ray.params.Line.threshold=.008*this.camera.position.distanceTo(this.controls.target);let n=[];for(let[s,r]of this.views)for(let[o,a]of s.items){let l=r.drawnItem(o)?.drawing.root;if(!l)continue;let c=this.hit(l);c!==null&&n.push({distance:c,device:s,item:a})}return n.sort((s,r)=>s.distance-r.distance),n[0]??null}hit(e){let t=null;return e.traverseVisible(n=>{let s=n.geometry;if(!s?.getAttribute("position"))return;if((s.index?.count??0)>3*xE){let o=(s.boundingBox??new ds).clone().applyMatrix4(n.matrixWorld),a=this.ray.ray.intersectBox(o,new O);a&&(t=Math.min(t??1/0,a.distanceTo(this.camera.position)));return}let r=this.ray.intersectObject(n,!1);r.length&&(t=Math.min(t??1/0,r[0].distance))}),t}hover(e,t){let n=this.parts.tip,s=this.handAt(e,t),r=s?null:this.itemAt(e,t);if(this.canvas.style.cursor=s?.info.pull&&this.model.can("control")?"grab":r?"pointer":"",this.hovered=r?this.describe(r.device,r.item):s?this.describeHand(s):"",n.hidden=this.hovered==="",n.hidden)return;n.textContent=this.hovered;let o=this.canvas.getBoundingClientRect();n.style.left=`${Math.min(o.width-n.offsetWidth-8,e-o.left+14)}px`,n.style.top=`${Math.max(4,Math.min(o.height-n.offsetHeight-8,t-o.top+14))}px`}describeHand(e){let t=this.frameOf(e);if(!t)return"";let n=e.info.pull&&this.model.can("control")?`
drag to pull it`:"";return`hand of ${e.info.name}: ${t.p.map(s=>(1e3*s).toFixed(1)).join(", ")} mm${n}`}describe(e,t){let n=e.claims.get(t.claim),s=n?n.mine?"this page":`${n.name||"unnamed"} (pid ${n.pid})`:"nobody",r=[`${t.kind.replaceAll("_"," ")}, slot ${t.slot}, of ${s}`],o=t.params.stiffness;o!==void 0&&r.push(`stiffness ${o} N/m`+(t.params.damping?`, damping ${t.params.damping} N s/m`:"")),t.probe&&r.push(`acts on probe ${t.probe}`);let a=t.felt;if(a){let l=a[2],c=Math.hypot(a[3],a[4],a[5]),h=[l&1?`touched, ${c.toFixed(2)} N`:c>.005?`${c.toFixed(2)} N`:"",l&2?"clamped to what the device allows":"",l&4?"contradicts others":"",l&8?"fading":"",l&16?"its application is silent":"",l&32?"asleep: out of reach":""].filter(Boolean);h.length&&r.push(h.join(", "))}return r.join(`
`)}handAt(e,t){let n=this.canvas.getBoundingClientRect();for(let[s,r]of this.views){if(!r.hand.visible)continue;let o=r.hand.getWorldPosition(new O).project(this.camera);if(o.z>1)continue;let a=n.left+(o.x+1)/2*n.width,l=n.top+(1-o.y)/2*n.height;if(Math.hypot(a-e,l-t)<18)return s}return null}handOnScreen(e){let t=this.views.get(e);if(!t)return null;let n=this.canvas.getBoundingClientRect(),s=t.hand.getWorldPosition(new O).project(this.camera);return{x:n.left+(s.x+1)/2*n.width,y:n.top+(1-s.y)/2*n.height}}listen(){let e=this.canvas;e.addEventListener("pointerdown",n=>{if(n.button!==0)return;let s=this.handAt(n.clientX,n.clientY),r=this.camera.getWorldDirection(new O);if(s?.info.pull&&this.model.can("control")&&s!==this.model.recording){let o=this.views.get(s).hand.getWorldPosition(new O);this.grip={device:s,plane:new jn().setFromNormalAndCoplanarPoint(r,o),item:null,from:o,sent:o.clone()}}else if(n.altKey&&this.model.can("render")){let o=this.itemAt(n.clientX,n.clientY);if(!o||!o.device.claims.get(o.item.claim)?.mine)return;let l=this.views.get(o.device).drawnItem(`${o.item.claim}:${o.item.slot}`).drawing.root.getWorldPosition(new O),c=new jn().setFromNormalAndCoplanarPoint(r,l),h=this.ray.ray.intersectPlane(c,new O);if(!h)return;this.grip={device:o.device,plane:c,item:o.item,from:h,sent:h.clone()}}else return;this.controls.enabled=!1,e.setPointerCapture(n.pointerId),e.style.cursor="grabbing",this.parts.tip.hidden=!0,n.stopImmediatePropagation()},{capture:!0}),e.addEventListener("pointermove",n=>{if(this.pointer=n.pointerType==="mouse"?{x:n.clientX,y:n.clientY}:null,!this.grip)return;this.at(n.clientX,n.clientY);let s=this.ray.ray.intersectPlane(this.grip.plane,new O);if(!s)return;let r=this.views.get(this.grip.device);if(!r)return;if(this.grip.item){let a=this.grip.device.claims.get(this.grip.item.claim)?.frame.scale??1,l=s.clone().sub(this.grip.sent).multiplyScalar(a);this.grip.sent.copy(s),this.events.drag(this.grip.device,this.grip.item,l.toArray());return}let o=s.clone().sub(r.root.position);r.target=o,this.events.pull(this.grip.device,o.toArray())});let t=()=>{if(!this.grip)return;let{device:n,item:s}=this.grip;this.grip=null,this.controls.enabled=!0,e.style.cursor="";let r=this.views.get(n);r&&(r.target=null),s||this.events.pull(n,null)};e.addEventListener("pointerup",t),e.addEventListener("pointercancel",t),e.addEventListener("lostpointercapture",t),e.addEventListener("pointerleave",()=>{this.pointer=null,this.parts.tip.hidden=!0,this.hovered=""}),e.addEventListener("contextmenu",n=>n.preventDefault())}picture(){return this.renderer?.render(this.scene,this.camera),new Promise(e=>this.canvas.toBlob(e,"image/png"))}get info(){if(this.by===null){let e=this.renderer?.getContext(),t=e?.getExtension("WEBGL_debug_renderer_info");this.by=e&&t?String(e.getParameter(t.UNMASKED_RENDERER_WEBGL)):""}return{triangles:this.renderer?.info.render.triangles??0,calls:this.renderer?.info.render.calls??0,by:this.by}}};var $n=new Nl;$n.note=(i,e)=>ut(i,e);var Vn={frames:0,messages:0,reconnects:0,workP50:0,workMax:0,drawP50:0,rate:0,items:0,triangles:0,calls:0,renderer:"",ageP50:0,ageP99:0,ageWithin:0},Vd=new URL("./live",location.href);Vd.protocol=Vd.protocol==="https:"?"wss:":"ws:";var Pi=new Dl(Vd.href,{message:i=>{try{$n.take(i)}catch(e){ut("error",e.message)}},reports:i=>$n.takeReports(i),strange:i=>ut("error",`knurl-web sent ${i}`),link:(i,e,t)=>{let n=oe("banner");if(n.hidden=i==="open",n.dataset.state=i,i==="open"){Pi.reconnects>0&&(ti.forgetAssets(),ut("info","Connected again."));return}if(i==="lost"){Mt(n,`${e[0].toUpperCase()}${e.slice(1)}; the next attempt is in ${t} s. What you see is the last that came.`);for(let s of $n.devices.values())s.frame=null,s.status=null;$n.forget()}else Mt(n,`${e}. Open the URL that knurl-web printed when it started; it has a new token.`)}}),ti=new Qh(oe("scene"),$n,{tip:oe("tip"),scale:oe("scale"),gizmo:oe("gizmo")},{pull:(i,e)=>ME(i.info.i,e),drag:(i,e,t)=>tu.drag(i,e,t),say:ut}),Vr=new Il($n),bE=new Ol($n,()=>Pi),tu=new kl($n,()=>Pi),Hr=new Gl($n);$n.asset=i=>{tu.sent(i)};$n.forgetting=()=>tu.remember();$n.on("recording",()=>ti.forgetAssets());var eu=null,Hd=!1;function ME(i,e){eu={device:i,target:e},Hd||SE()}async function SE(){for(Hd=!0;eu;){let i=eu;eu=null;try{await Pi.request("pull",i)}catch(e){ut("error",e.message)}}Hd=!1}var Jo=Bm(oe("tabs"));Jo("tab-state");oe("theme").addEventListener("click",Xu);oe("fit").addEventListener("click",()=>ti.fit());oe("follow").addEventListener("click",()=>Wy());for(let i of["x","y","z"])oe(`look-${i}`).addEventListener("click",()=>ti.look(i));oe("shot").addEventListener("click",()=>{wE()});oe("help").addEventListener("click",()=>oe("help-dialog").showModal());for(let i of document.querySelectorAll("dialog"))i.addEventListener("click",e=>e.target===i&&i.close());for(let i of document.querySelectorAll("[data-close]"))i.addEventListener("click",()=>i.closest("dialog")?.close());function Wy(){let i=ti.toggleFollow();oe("follow").setAttribute("aria-pressed",String(i))}async function wE(){let i=await ti.picture();i&&br("knurl-scene.png",i)}var AE={"?":()=>oe("help-dialog").showModal(),f:()=>ti.fit(),h:Wy,x:()=>ti.look("x"),y:()=>ti.look("y"),z:()=>ti.look("z"),t:Xu," ":()=>Hr.isOpen?Hr.toggle():Vr.setPaused(!Vr.paused),p:()=>Vr.setPaused(!Vr.paused),a:()=>oe("arm").click(),d:()=>oe("disarm").click(),r:()=>oe("reset").click(),o:()=>oe("open").click(),1:()=>Jo("tab-state"),2:()=>Jo("tab-clients"),3:()=>Jo("tab-playground"),4:()=>Jo("tab-log"),",":()=>Hr.step(-.001),".":()=>Hr.step(.001)};window.addEventListener("keydown",i=>{let e=i.target;if(i.ctrlKey||i.metaKey||i.altKey||document.querySelector("dialog[open]")||/^(INPUT|SELECT|TEXTAREA)$/.test(e.tagName)||i.key===" "&&/^(BUTTON|SUMMARY)$/.test(e.tagName))return;let t=AE[i.key];t&&(i.preventDefault(),t())});var Wd=oe("drop");window.addEventListener("dragover",i=>{i.dataTransfer?.types.includes("Files")&&(i.preventDefault(),Wd.hidden=!1)});window.addEventListener("dragleave",i=>{i.relatedTarget===null&&(Wd.hidden=!0)});window.addEventListener("drop",i=>{i.preventDefault(),Wd.hidden=!0;for(let e of i.dataTransfer?.files??[])/\.mcap$/i.test(e.name)?Hr.open(e):(Jo("tab-playground"),tu.loadMesh(e))});var Gd=new Pl;window.setInterval(async()=>{let i=performance.now()/1e3;try{let e=await Pi.request("clock");Gd.take(i,performance.now()/1e3,Number(e.t))}catch{}},1e3);var zr=new Float32Array(600),Vy=new Float32Array(600),zd=new Float64Array(600),Hy=0;function Gy(i,e){return e===0?0:i.slice(0,e).sort()[e>>1]}function Xy(i){requestAnimationFrame(Xy);let e=performance.now();Hr.tick(i),ti.draw(i/1e3);let t=performance.now(),n=$n.recording?null:$n.current()?.frame;n&&Gd.drawn(n.t,t/1e3),i-Hy>125?(Hy=i,bE.slow()):Vr.draw();let s=Vn.frames%zr.length;if(zr[s]=performance.now()-e+Pi.work,Vy[s]=t-e,zd[s]=i,Pi.work=0,Vn.frames++,Vn.frames%20===0){let r=Math.min(Vn.frames,zr.length);Vn.workP50=Gy(zr,r),Vn.drawP50=Gy(Vy,r),Vn.workMax=Math.max(...zr.subarray(0,r));let o=Vn.frames>zr.length?zd[Vn.frames%zr.length]:zd[0];Vn.rate=1e3*(r-1)/(i-o),Object.assign(Vn,{messages:Pi.messages,reconnects:Pi.reconnects});let a=Gd.age;Object.assign(Vn,{ageP50:a.p50,ageP99:a.p99,ageWithin:a.within});let{triangles:l,calls:c,by:h}=ti.info;Object.assign(Vn,{triangles:l,calls:c,renderer:h})}Vn.messages=Pi.messages,Vn.reconnects=Pi.reconnects,Vn.items=[...$n.devices.values()].reduce((r,o)=>r+o.items.size,0)}var $y=new ResizeObserver(()=>{ti.resize(),Vr.resize()});$y.observe(oe("view"));$y.observe(oe("charts"));ti.resize();Pi.open();requestAnimationFrame(Xy);window.addEventListener("error",i=>ut("error",`The page has a mistake: ${i.message}`));window.addEventListener("unhandledrejection",i=>ut("error",`The page has a mistake: ${i.reason instanceof Error?i.reason.message:String(i.reason)}`));Object.assign(window,{knurl:{model:$n,scene:ti.scene,counters:Vn,view:ti,charts:Vr,player:Hr,connection:Pi,resetCounters:()=>{Vn.frames=0}}});})();
